// Stored experiments: finished points, for --resume.
#include "rigel/problems/experiments/experiment_report.h"
#include "rigel/problems/experiments/experiment_store.h"
#include "rigel/test/fuzz/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using rigel::fuzz::Require;
  static const rigel::fuzz::Folder folder;
  static const rigel::ExperimentPlan plan = [] {
    rigel::ExperimentOptions options;
    options.quick = true;
    options.pairs = 1;
    rigel::ExperimentPlan made;
    std::string error;
    Require(rigel::PlanExperiment(*rigel::FindExperiment("rotation-angle"), options, &made, &error),
            error);
    return made;
  }();
  std::string error;

  // The first line of the file says which run it is, the input stands for the others.
  folder.Write("points.jsonl",
               rigel::PlanLine(plan, "") + std::string(reinterpret_cast<const char*>(data), size));
  rigel::ExperimentStore store;
  if (store.Open(folder.Path("points.jsonl"), plan, true, &error)) {
    rigel::ExperimentJson(plan, store.RowsInOrder(plan));
    rigel::ExperimentCsv(plan, store.RowsInOrder(plan));
    rigel::ExperimentTable(plan, store.RowsInOrder(plan));
  } else {
    rigel::fuzz::RequireMessage(error);
  }
  return 0;
}
