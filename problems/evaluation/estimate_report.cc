#include "rigel/problems/evaluation/estimate_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include <nlohmann/json.hpp>

#include "rigel/core/angles.h"
#include "rigel/problems/evaluation/drift_report.h"
#include "rigel/problems/io/csv.h"
#include "rigel/problems/io/match_file.h"
#include "rigel/problems/io/printable.h"
#include "rigel/problems/io/report_json.h"
#include "rigel/problems/io/table.h"

namespace rigel {
namespace {

using Json = nlohmann::ordered_json;

// The file name without ".matches", shortened and printable: a cell of a table.
std::string ShortName(const std::string& name) {
  const size_t slash = name.find_last_of('/');
  std::string text = slash == std::string::npos ? name : name.substr(slash + 1);
  if (IsMatchFileName(text)) text.resize(text.rfind(".matches"));
  // Characters: with more, a line of the table would exceed 100.
  constexpr size_t kWidth = 16;
  return Shortened(Printable(text), kWidth);
}

// "R" rotation, "t" direction of translation, "s" scale; "-" where it is not observable.
std::string ObservableLetters(const RefineSummary& refine) {
  return std::string(refine.rotation_observable ? "R" : "-") +
         (refine.translation_observable ? "t" : "-") + (refine.scale_observable ? "s" : "-");
}

Json MotionJson(const Pose& pose) {
  return {{"q_wxyz", QuaternionJson(pose.R)}, {"t", {pose.t.x(), pose.t.y(), pose.t.z()}}};
}

// Three digits, of small ones in powers of ten.
std::string ResidualText(double px) {
  // Pixels: a smaller number would be shown as 0.000.
  constexpr double kLeast = 5e-4;
  if (!(px > 0.0) || px >= kLeast) return FormatFitted(px, 3, 5);
  char text[32];
  std::snprintf(text, sizeof(text), "%.0e", px);
  return text;
}

// The solvers that auto tried. Those that were not needed are left out.
Json TrialsJson(const std::vector<SolverTrial>& trials) {
  Json entries = Json::array();
  for (const SolverTrial& trial : trials) {
    if (trial.iterations == 0 && trial.note == kNotNeeded) continue;
    entries.push_back({{"solver", trial.solver},
                       {"iterations", trial.iterations},
                       {"inliers", trial.num_inliers},
                       {"note", trial.note}});
  }
  return entries;
}

template <class Matrix>
Json MatrixJson(const Matrix& matrix) {
  Json rows = Json::array();
  for (int i = 0; i < matrix.rows(); ++i) {
    Json row = Json::array();
    for (int j = 0; j < matrix.cols(); ++j) row.push_back(matrix(i, j));
    rows.push_back(row);
  }
  return rows;
}

Json VectorJson(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

void PutUncertainty(const RefineSummary& refine, Json* entry) {
  if (refine.covariance) {
    PutKnown("rotation_sd_deg", RadToDeg(refine.rotation_sigma), entry);
    if (refine.translation_observable) {
      PutKnown("translation_dir_sd_deg", RadToDeg(refine.direction_sigma), entry);
    }
    if (refine.RigDirectionKnown()) {
      PutKnown("rig_direction_sd_deg", RadToDeg(refine.rig_direction_sigma), entry);
      (*entry)["rig_direction"] = VectorJson(refine.rig_direction);
    }
    (*entry)["rig_center"] = VectorJson(refine.rig_center);
    PutKnown("length_sd", refine.length_sigma, entry);
    (*entry)["covariance"] = MatrixJson(*refine.covariance);
    (*entry)["covariance_valid"] = refine.covariance_valid;
    if (!refine.covariance_valid) (*entry)["covariance_note"] = refine.covariance_note;
    if (refine.calibration_covariance) {
      (*entry)["calibration_covariance"] = MatrixJson(*refine.calibration_covariance);
      for (const UnalignedMatrix<6, 7>& gain : refine.calibration_gain) {
        (*entry)["calibration_gain"].push_back(MatrixJson(gain));
      }
    }
    if (!refine.weakest_direction.empty()) {
      (*entry)["weakest_direction"] = refine.weakest_direction;
    }
  }
  PutKnown("relative_scale_sd", refine.relative_scale_sigma, entry);
}

void PutRefined(const MotionEstimate& e, Json* entry) {
  const RefineSummary& refine = e.refine;
  (*entry)["refined"] = MotionJson(e.pose);
  PutKnown("median_residual_px", refine.median_residual_px, entry);
  PutKnown("noise_px", refine.noise_px, entry);
  (*entry)["rotation_observable"] = refine.rotation_observable;
  (*entry)["translation_observable"] = refine.translation_observable;
  (*entry)["scale_observable"] = refine.scale_observable;
  if (refine.stands) (*entry)["stands"] = true;
  Json& camera_pairs = (*entry)["camera_pairs"] = Json::array();
  for (const CameraPairFit& fit : refine.camera_pairs) {
    camera_pairs.push_back({{"cameras", {fit.camera1, fit.camera2}},
                            {"rows", fit.rows},
                            {"inliers", fit.inliers},
                            {"noise_px", fit.noise_px}});
  }
  for (const RigDoubt& doubt : e.rig_doubts) (*entry)["rig_doubts"].push_back(doubt.message);
  if (refine.other_motion) (*entry)["other_motion"] = MotionJson(*refine.other_motion);
  PutUncertainty(refine, entry);
}

void PutMotion(const MotionEstimate& e, bool times, Json* entry) {
  (*entry)["solver"] = e.solver;
  (*entry)["inliers"] = e.num_inliers;
  (*entry)["doubtful"] = e.doubtful;
  if (e.doubtful) (*entry)["reason"] = e.doubt;
  (*entry)["iterations"] = e.iterations;
  if (times) (*entry)["time_ms"] = {{"ransac", e.ransac_ms}, {"refine", e.refine_ms}};
  (*entry)["raw"] = MotionJson(e.raw);
  if (e.refine.IsSolutionUsable()) PutRefined(e, entry);
}

Json PairJson(const FramePair& pair, const MatchCount& matches, const MotionEstimate& e,
              bool times) {
  Json entry;
  entry["pair"] = pair.name;
  if (!pair.sequence.empty()) entry["sequence"] = pair.sequence;
  entry["status"] = EstimateStatusName(e.status);
  const bool stopped = e.stopped != StopReason::kNone;
  if (e.status != EstimateStatus::kSuccess || stopped) entry["message"] = e.message;
  if (stopped) entry["stopped"] = StopReasonName(e.stopped);
  if (pair.time1 && pair.time2) entry["time"] = {*pair.time1, *pair.time2};
  entry["matches"] = matches.all;
  if (e.trials.size() > 1) entry["auto"] = TrialsJson(e.trials);
  if (e.HasMotion()) PutMotion(e, times, &entry);
  return entry;
}

// What the table shows of a motion.
struct Shown {
  bool refined = false;
  bool not_asked = false;  // no refinement was asked for, or it was stopped
  bool rotation = false, direction = false, scale = false;
};

Shown ShownOf(const MotionEstimate& e, const MatchCount& matches) {
  Shown shown;
  shown.refined = e.refine.IsSolutionUsable();
  // Without a refinement nothing is known of what can be observed.
  shown.not_asked = (e.status == EstimateStatus::kSuccess && !shown.refined) ||
                    e.refine.termination == Termination::kStopped;
  shown.rotation = shown.not_asked || e.refine.rotation_observable;
  shown.direction = shown.not_asked || e.refine.translation_observable;
  shown.scale = shown.not_asked ? e.raw.has_scale && matches.any_inter
                                : KnowsLength(e.refine) && e.refine.translation_observable;
  return shown;
}

std::vector<std::string> MotionRow(const std::string& name, const MotionEstimate& e,
                                   const Shown& shown) {
  const auto cell = [](bool known, const std::string& text) { return known ? text : "-"; };
  const auto sigma = [&](bool known, double radians) {
    return cell(known && shown.refined && radians >= 0, FormatFitted(RadToDeg(radians), 3, 5));
  };
  const Eigen::Vector3d d = e.pose.t.normalized();
  const bool stopped = e.stopped != StopReason::kNone;
  return {name,
          stopped ? StopReasonName(e.stopped) : EstimateStatusName(e.status),
          cell(shown.rotation, FormatFitted(RadToDeg(LogSO3(e.pose.R).norm()), 3, 6)),
          sigma(shown.rotation, e.refine.rotation_sigma),
          cell(shown.direction, FormatNumber(d.x(), 4)),
          cell(shown.direction, FormatNumber(d.y(), 4)),
          cell(shown.direction, FormatNumber(d.z(), 4)),
          sigma(shown.direction, e.refine.direction_sigma),
          cell(shown.scale, FormatFitted(e.pose.t.norm(), 4, 6)),
          std::to_string(e.num_inliers),
          cell(shown.refined, ResidualText(e.refine.median_residual_px)),
          cell(shown.refined, ObservableLetters(e.refine))};
}

// The lines below the table that explain single motions.
std::string MotionRemarks(const std::string& name, const MotionEstimate& e) {
  if (!e.HasMotion()) return "";
  std::string text;
  // Of a motion that auto doubts: the doubt of another solver is told on stderr.
  if (e.doubtful && e.trials.size() > 1) text += name + ": doubtful: " + e.doubt + "\n";
  if (e.refine.IsSolutionUsable() && !e.refine.translation_observable) {
    text += name + ": " + e.refine.ObservabilityReport() + "\n";
  }
  return text;
}

// ",qw,qx,qy,qz,tx,ty,tz".
std::string CsvMotion(const Pose& pose) {
  const Eigen::Quaterniond q = pose.Quaternion();
  std::string cells;
  for (const double v : {q.w(), q.x(), q.y(), q.z(), pose.t.x(), pose.t.y(), pose.t.z()}) {
    cells += "," + CsvNumber(v);
  }
  return cells;
}

// The cells of a motion, from qw on.
std::string CsvMotionCells(const MotionEstimate& e, int num_matches, bool times) {
  const RefineSummary& r = e.refine;
  const bool refined = r.IsSolutionUsable();
  const auto known = [&](double value) {
    return refined && value >= 0 ? CsvNumber(value) : std::string();
  };
  const auto flag = [&](bool value) { return refined ? std::string(value ? "1" : "0") : ""; };
  const auto time = [&](double ms) { return times ? CsvNumber(ms) : std::string(); };
  return CsvMotion(e.pose) + "," + CsvNumber(e.pose.t.norm()) + "," + std::to_string(num_matches) +
         "," + std::to_string(e.num_inliers) + "," + known(r.median_residual_px) + "," +
         known(RadToDeg(r.rotation_sigma)) + "," +
         (r.translation_observable ? known(RadToDeg(r.direction_sigma)) : "") + "," +
         known(r.relative_scale_sigma) + "," + flag(r.rotation_observable) + "," +
         flag(r.translation_observable) + "," + flag(r.scale_observable) + CsvMotion(e.raw) + "," +
         time(e.ransac_ms) + "," + time(e.refine_ms);
}

}  // namespace

std::string EstimateTable(const EstimateReport& report) {
  const std::vector<FramePair>& pairs = report.pairs;
  // The widths given keep it to 100 columns.
  Table table(1);
  table.AddHeader(
      {"pair", "status", "angle", "sd", "direction", "of t", "", "sd", "|t|", "inl", "res", "obs"});
  table.AddHeader({"", "", "[deg]", "[deg]", "x", "y", "z", "[deg]", "[m]", "", "[px]", ""});
  bool any_unobservable = false;
  bool any_not_asked = false;
  std::string remarks;
  for (size_t k = 0; k < pairs.size(); ++k) {
    const MotionEstimate& e = report.estimates[k];
    const std::string name = ShortName(pairs[k].name);
    remarks += MotionRemarks(name, e);
    if (!e.HasMotion()) {
      table.AddRow(
          {name, EstimateStatusName(e.status), "-", "-", "-", "-", "-", "-", "-", "-", "-", "-"});
      continue;
    }
    const Shown shown = ShownOf(e, report.matches[k]);
    any_not_asked = any_not_asked || shown.not_asked;
    any_unobservable = any_unobservable || (!shown.not_asked && (!shown.direction || !shown.scale));
    table.AddRow(MotionRow(name, e, shown));
  }
  std::string text = table.Format();
  if (any_unobservable) {
    text +=
        "\n\"-\": not observable, as the translation direction where |t| is consistent with zero; "
        "or not\ncomputed. obs: R rotation, t direction of translation, s scale |t|.\n";
  }
  if (any_not_asked) {
    text +=
        "\n\"-\": not computed. Without a finished refinement it is not known what the matches "
        "determine: the direction\nof t may mean nothing; |t| is left out where no match is "
        "between two cameras.\n";
  }
  return text + remarks;
}

std::vector<std::string> RigDoubtLines(const EstimateReport& report) {
  struct Line {
    RigDoubt first;
    std::string pair;
    int others = 0;
  };
  std::vector<Line> lines;
  for (size_t k = 0; k < report.pairs.size(); ++k) {
    for (const RigDoubt& doubt : report.estimates[k].rig_doubts) {
      const auto same = std::find_if(lines.begin(), lines.end(), [&](const Line& line) {
        return line.first.kind == doubt.kind && line.first.camera1 == doubt.camera1 &&
               line.first.camera2 == doubt.camera2;
      });
      if (same != lines.end()) {
        ++same->others;
      } else {
        lines.push_back({doubt, report.pairs[k].name, 0});
      }
    }
  }
  std::vector<std::string> texts;
  for (const Line& line : lines) {
    texts.push_back(Printable(line.pair) + ": " + line.first.message +
                    (line.others == 0 ? std::string()
                                      : " (" + std::to_string(line.others + 1) + " files alike)"));
  }
  return texts;
}

std::string EstimateJson(const EstimateReport& report, bool times) {
  const std::vector<FramePair>& pairs = report.pairs;
  Json json = NewReport("rigel-estimate 1");
  json["options"] = OptionsJson(report.options);
  // Written pair by pair: a JSON tree of many pairs would be large.
  std::string text = JsonText(json, 2);
  text.resize(text.size() - 2);  // the line break and bracket of the end
  text += ",\n  \"pairs\": [";
  for (size_t k = 0; k < pairs.size(); ++k) {
    const Json entry = PairJson(pairs[k], report.matches[k], report.estimates[k], times);
    text += k == 0 ? "\n    " : ",\n    ";
    for (const char c : JsonText(entry, 2)) {
      text += c;
      if (c == '\n') text += "    ";
    }
  }
  text += pairs.empty() ? "]" : "\n  ]";
  if (report.trajectories) text += ",\n  \"trajectories\": " + TrajectoriesJson(report);
  return PrintableJson(text + "\n}\n");
}

std::string EstimateCsv(const EstimateReport& report, bool times) {
  const std::vector<FramePair>& pairs = report.pairs;
  std::string text =
      "pair,status,time1,time2,qw,qx,qy,qz,tx,ty,tz,norm_t,matches,inliers,median_residual_px,"
      "rotation_sd_deg,translation_dir_sd_deg,relative_scale_sd,rotation_observable,"
      "translation_observable,scale_observable,raw_qw,raw_qx,raw_qy,raw_qz,raw_tx,raw_ty,raw_tz,"
      "ransac_ms,refine_ms\n";
  for (size_t k = 0; k < pairs.size(); ++k) {
    const FramePair& pair = pairs[k];
    const MotionEstimate& e = report.estimates[k];
    const int num_matches = report.matches[k].all;
    // Without a motion: 8 empty cells before the number of matches, 17 after it.
    const std::string cells =
        e.HasMotion()
            ? CsvMotionCells(e, num_matches, times)
            : std::string(8, ',') + "," + std::to_string(num_matches) + std::string(17, ',');
    text += CsvText(pair.name) + "," + CsvText(EstimateStatusName(e.status)) + "," +
            (pair.time1 ? CsvNumber(*pair.time1) : "") + "," +
            (pair.time2 ? CsvNumber(*pair.time2) : "") + cells + "\n";
  }
  return text;
}

}  // namespace rigel
