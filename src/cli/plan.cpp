#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "base/json.h"
#include "base/log.h"
#include "cli/command.h"
#include "cli/job_options.h"
#include "cli/result.h"
#include "cli/scene_notes.h"
#include "cli/scene_summary.h"
#include "job/job_look.h"
#include "plan/plan_frame.h"
#include "plan/posed_scene.h"
#include "render/frame_names.h"
#include "scene/cut_outs.h"

namespace candela::cli {
namespace {

struct PlanOptions {
  JobOptions job;
  MomentOptions moment;
  std::vector<std::string> outputs;
  bool dot = false;
};

// What a command is asked of: the job, its scene, and when.
struct Asked {
  Job job;
  Scene scene;
  double time_s = 0;
};
Expected<Asked> read_asked(CLI::App& command, const PlanOptions& o) {
  if (auto read = read_config(command, o.job.config); !read) return std::unexpected(read.error());
  set_log_level(o.job);
  auto job = job_of(o.job);
  if (!job) return std::unexpected(job.error());
  const auto moment = moment_of(o.job, o.moment);
  if (!moment) return std::unexpected(moment.error());
  auto scene = load_scene(*job);
  if (!scene) return std::unexpected(scene.error());
  if (auto noted = note_scene(*scene, strictness(o.job.strict)); !noted) return std::unexpected(noted.error());
  const auto look = look_of(*job);
  if (!look) return std::unexpected(look.error());
  if (const std::string left_out = left_out_of(*job, *look); !left_out.empty()) {
    if (strictness(o.job.strict) == Strictness::all)
      return fail(ErrorKind::input, job->scene, "--strict refuses the scene: {}", left_out);
    log::warning("{}", left_out);
  }
  return Asked{std::move(*job), std::move(*scene), moment->time_s};
}

Expected<WantedOutputs> wanted_outputs(const PlanOptions& o, const Job& job) {
  WantedOutputs wanted{
      .linear = o.outputs.empty(), .display = false, .display_bits = job.png_bits, .files = !o.outputs.empty()};
  for (const std::string& output : o.outputs) {
    const auto format = output_format(output);
    if (!format) return std::unexpected(format.error());
    (*format == OutputFormat::exr ? wanted.linear : wanted.display) = true;
  }
  return wanted;
}

std::string look_text(const Job& job, const Look& look) {
  const std::string line = look_line(job, look);
  return line.empty() ? line : "look " + line + "\n";
}
std::string plan_with_look(const FramePlan& plan, const Job& job, const Look& look) {
  if (job.look.empty()) return plan_json(plan) + "\n";
  auto j = own_json(plan_json(plan));
  j["look"] = look_json(job, look);
  return j.dump(2) + "\n";
}

Expected<int> run_plan(CLI::App& command, const PlanOptions& o) {
  const auto asked = read_asked(command, o);
  if (!asked) return std::unexpected(asked.error());
  const Job& job = asked->job;
  const auto wanted = wanted_outputs(o, job);
  if (!wanted) return std::unexpected(wanted.error());
  const auto frame = plan_frame(job, asked->scene, *wanted, asked->time_s);
  if (!frame) return std::unexpected(frame.error());
  if (o.dot && o.job.json) return fail(ErrorKind::usage, "--dot", "--dot and --json both ask for stdout");
  for (const std::string& note : frame->notes) log::info("{}", note);
  const FramePlan& plan = frame->graph().plan;
  auto printed = o.dot        ? print(plan_dot(plan))
                 : o.job.json ? print(plan_with_look(plan, job, frame->request.look))
                              : print(plan_text(plan) + look_text(job, frame->request.look));
  if (!printed) return std::unexpected(printed.error());
  return 0;
}

Expected<int> run_facts(CLI::App& command, const PlanOptions& o) {
  const auto asked = read_asked(command, o);
  if (!asked) return std::unexpected(asked.error());
  const auto& [job, scene, time_s] = *asked;
  auto frame = survey_frame(job, scene, time_s);
  if (!frame) return std::unexpected(frame.error());
  frame->facts.cut_outs = cut_out_materials(scene);
  auto facts = own_json(facts_json(frame->facts));
  facts["extensions"] = extensions_json(scene);
  facts["variants"] = scene.variants;
  facts["variant"] = nullptr;
  if (scene.variant >= 0) facts["variant"] = scene.variants[size_t(scene.variant)];
  add_summary(facts, scene, job, *frame);
  const auto printed = print(o.job.json ? facts.dump(2) + "\n" : summary_text(scene, job, *frame));
  if (!printed) return std::unexpected(printed.error());
  return 0;
}

std::shared_ptr<PlanOptions> add_common(CLI::App& command, Renderer renderer) {
  auto o = std::make_shared<PlanOptions>();
  add_job_options(command, o->job, renderer);
  add_moment_options(command, o->moment);
  add_strict_option(command, o->job);
  command.add_option("--config", o->job.config, "Options from an INI or TOML file; the command line overrides it")
      ->type_name("FILE");
  command.add_flag("--quiet", o->job.quiet, "Only warnings and errors on stderr");
  command.add_flag("--verbose", o->job.verbose, "More on stderr");
  return o;
}

}  // namespace

void add_plan(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("plan", "Print what would run, what is left out and why, and the memory; needs no device");
  auto o = add_common(*command, Renderer::gpu);
  command->add_option("-o,--output", o->outputs, "Plan for these files (only the endings matter); by default for EXR")
      ->allow_extra_args(false)
      ->type_name("FILE");
  command->add_flag("--json", o->job.json, "As JSON");
  command->add_flag("--dot", o->dot, "As a Graphviz graph");
  command->callback([command, o, &action] { action = [command, o] { return run_plan(*command, *o); }; });
}

void add_facts(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("facts", "Print what the scene holds at one moment; needs no device");
  auto o = add_common(*command, Renderer::none);
  command->add_flag("--json", o->job.json, "As JSON, with everything that decides which passes run");
  command->callback([command, o, &action] { action = [command, o] { return run_facts(*command, *o); }; });
}

}  // namespace candela::cli
