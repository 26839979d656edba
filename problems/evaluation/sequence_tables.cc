#include "rigel/problems/evaluation/sequence_tables.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <optional>

#include "rigel/problems/evaluation/paper_figures.h"
#include "rigel/problems/io/table.h"

namespace rigel {
namespace {

// Characters of a line: tables of all tools keep to them.
constexpr size_t kMaxWidth = 100;
// Characters of a figure: FormatFitted() leaves out decimals to keep to them.
constexpr size_t kFigureWidth = 6;
constexpr size_t kMaxName = 12;  // characters of a sequence's name, shortened to them

using Figure = std::optional<double>;

// A kind of table.
struct Quantity {
  const char* title;
  const char *first, *second;  // what stands in the two columns of a solver
  PaperTable paper;
  int digits;
  // The figures of the two columns.
  std::array<Figure, 2> (*of)(const SolverSummary&);
};

const Quantity kQuantities[] = {
    {"time [ms], mean: of RANSAC, with the refinement", "RANSAC", "both", PaperTable::kRuntimeMs, 2,
     [](const SolverSummary& s) {
       std::array<Figure, 2> figures;
       if (s.ransac_ms) figures[0] = s.ransac_ms->mean;
       if (s.ransac_ms && s.refine_ms && s.refined_rotation_deg) {
         figures[1] = s.ransac_ms->mean + s.refine_ms->mean;
       }
       return figures;
     }},
    {"rotation error [deg], median", "raw", "refined", PaperTable::kRotationDeg, 4,
     [](const SolverSummary& s) {
       return std::array<Figure, 2>{MedianOf(s.raw_rotation_deg), MedianOf(s.refined_rotation_deg)};
     }},
    {"translation direction error [deg], median", "raw", "refined", PaperTable::kDirectionDeg, 4,
     [](const SolverSummary& s) {
       return std::array<Figure, 2>{MedianOf(s.raw_direction_deg),
                                    MedianOf(s.refined_direction_deg)};
     }},
};

// `text`, right-aligned; longer texts stay as they are.
std::string Padded(const std::string& text, size_t width) {
  return text.size() < width ? std::string(width - text.size(), ' ') + text : text;
}

// The names of solvers and sequences in the order of first appearance.
template <class Name>
std::vector<std::string> Names(const std::vector<SolverSummary>& summaries, Name name) {
  std::vector<std::string> names;
  for (const SolverSummary& s : summaries) {
    if (std::find(names.begin(), names.end(), name(s)) == names.end()) names.push_back(name(s));
  }
  return names;
}

const SolverSummary* Find(const std::vector<SolverSummary>& summaries, const std::string& solver,
                          const std::string& sequence) {
  for (const SolverSummary& s : summaries) {
    if (s.solver == solver && s.sequence == sequence) return &s;
  }
  return nullptr;
}

// One solver's column: its name in lines and a text for each sequence.
struct Column {
  std::vector<std::string> header;
  std::vector<std::string> cells;
};

// The figures of one of the two columns of all solvers in one row, as text; the best marked.
std::vector<std::string> Marked(const std::vector<Figure>& figures, int digits) {
  std::vector<std::string> texts;
  for (const Figure& figure : figures) texts.push_back(FormatFitted(figure, digits, kFigureWidth));
  // Figures are compared as they are shown.
  const auto shown = [](const std::string& text) { return std::strtod(text.c_str(), nullptr); };
  const std::string* best = nullptr;
  bool all_equal = true;
  for (const std::string& text : texts) {
    if (text == "-") continue;
    if (best != nullptr && text != *best) all_equal = false;
    if (best == nullptr || shown(text) < shown(*best)) best = &text;
  }
  const std::string best_text = best == nullptr || all_equal ? "" : *best;
  for (std::string& text : texts) text += text == best_text ? "*" : " ";
  return texts;
}

// The name in lines of at most `width`, parted after a dash.
std::vector<std::string> Wrapped(const std::string& name, size_t width) {
  std::vector<std::string> lines = {""};
  std::string part;
  for (const char c : name + "-") {
    part += c;
    if (c != '-') continue;
    if (!lines.back().empty() && lines.back().size() + part.size() > width + 1)
      lines.emplace_back();
    lines.back() += part;
    part.clear();
  }
  lines.back().pop_back();  // the dash that was added
  return lines;
}

std::vector<Column> Columns(const Quantity& quantity, const std::vector<SolverSummary>& summaries,
                            const std::vector<std::string>& solvers,
                            const std::vector<std::string>& sequences) {
  std::vector<Column> columns(solvers.size());
  std::vector<bool> has_paper(solvers.size());
  for (size_t c = 0; c < solvers.size(); ++c) {
    has_paper[c] = std::any_of(sequences.begin(), sequences.end(), [&](const std::string& s) {
      return PaperFigure(quantity.paper, solvers[c], s).has_value();
    });
  }
  for (const std::string& sequence : sequences) {
    std::array<std::vector<Figure>, 2> figures;
    for (const std::string& solver : solvers) {
      const SolverSummary* summary = Find(summaries, solver, sequence);
      const auto both = summary == nullptr ? std::array<Figure, 2>() : quantity.of(*summary);
      for (int k = 0; k < 2; ++k) figures[k].push_back(both[k]);
    }
    const auto first = Marked(figures[0], quantity.digits);
    const auto second = Marked(figures[1], quantity.digits);
    for (size_t c = 0; c < solvers.size(); ++c) {
      std::string cell =
          Padded(first[c], kFigureWidth + 1) + " " + Padded(second[c], kFigureWidth + 1);
      if (has_paper[c]) {
        const Figure paper = PaperFigure(quantity.paper, solvers[c], sequence);
        cell += " " + Padded(FormatFitted(paper, quantity.digits, kFigureWidth), kFigureWidth);
      }
      columns[c].cells.push_back(cell);
    }
  }
  for (size_t c = 0; c < solvers.size(); ++c) {
    std::string names = Padded(quantity.first, kFigureWidth) + " " +
                        Padded(quantity.second, kFigureWidth + 1) + " ";
    if (has_paper[c]) names += " " + Padded("paper", kFigureWidth);
    columns[c].header = Wrapped(solvers[c], names.size());
    columns[c].header.push_back(names);
  }
  return columns;
}

// Columns begin to end - 1.
std::string Format(const std::vector<std::string>& sequences, const std::vector<int>& pairs,
                   const std::vector<Column>& columns, size_t begin, size_t end) {
  Table table;
  size_t lines = 0;
  for (size_t c = begin; c < end; ++c) lines = std::max(lines, columns[c].header.size());
  for (size_t line = 0; line < lines; ++line) {
    const bool last = line + 1 == lines;
    std::vector<std::string> row = {last ? "sequence" : "", last ? "pairs" : ""};
    for (size_t c = begin; c < end; ++c) {
      const std::vector<std::string>& header = columns[c].header;
      const size_t missing = lines - header.size();
      row.push_back(line < missing ? "" : header[line - missing]);
    }
    table.AddHeader(row);
  }
  for (size_t r = 0; r < sequences.size(); ++r) {
    std::vector<std::string> row = {Shortened(sequences[r], kMaxName), std::to_string(pairs[r])};
    for (size_t c = begin; c < end; ++c) row.push_back(columns[c].cells[r]);
    table.AddRow(row);
  }
  return table.Format();
}

bool IsNarrow(const std::string& text) {
  size_t width = 0;
  for (const char c : text) {
    if (c == '\n') {
      width = 0;
    } else if ((c & 0xc0) != 0x80 && ++width > kMaxWidth) {
      return false;
    }
  }
  return true;
}

}  // namespace

std::string SequenceTables(const std::vector<SolverSummary>& summaries) {
  const auto solvers = Names(summaries, [](const SolverSummary& s) { return s.solver; });
  const auto sequences = Names(summaries, [](const SolverSummary& s) { return s.sequence; });
  std::vector<int> pairs;
  for (const std::string& sequence : sequences) {
    const SolverSummary* summary = Find(summaries, solvers.front(), sequence);
    pairs.push_back(summary == nullptr ? 0 : summary->pairs);
  }
  std::string text;
  bool any_paper = false;
  for (const Quantity& quantity : kQuantities) {
    const bool any = std::any_of(summaries.begin(), summaries.end(), [&](const SolverSummary& s) {
      return quantity.of(s)[0].has_value();
    });
    if (!any) continue;
    const std::vector<Column> columns = Columns(quantity, summaries, solvers, sequences);
    text += (text.empty() ? "" : "\n") + std::string(quantity.title) + "\n";
    for (size_t begin = 0; begin < columns.size();) {
      size_t end = begin + 1;
      std::string table = Format(sequences, pairs, columns, begin, end);
      while (end < columns.size()) {
        const std::string wider = Format(sequences, pairs, columns, begin, end + 1);
        if (!IsNarrow(wider)) break;
        table = wider;
        ++end;
      }
      text += (begin > 0 ? "\n" : "") + table;
      begin = end;
    }
    for (const Column& column : columns) {
      any_paper = any_paper || column.header.back().find("paper") != std::string::npos;
    }
  }
  if (text.empty()) return text;
  text += "\n*: the best of its row, of all solvers.\n";
  if (any_paper) {
    text +=
        "paper: the figures of Li, Liu, Han, Lv on KITTI's images; their matches, priors and "
        "machine.\n";
  }
  return text;
}

std::string BestInBold(const std::string& tables) {
  constexpr char kFigure[] = "0123456789.e-";
  std::string bold;
  for (const char c : tables) {
    if (c == '*') {
      const size_t last = bold.find_last_not_of(kFigure);
      const size_t begin = last == std::string::npos ? 0 : last + 1;
      // Not the asterisk of the legend.
      if (begin < bold.size()) bold.insert(begin, "\033[1m").append("\033[0m");
    }
    bold += c;
  }
  return bold;
}

}  // namespace rigel
