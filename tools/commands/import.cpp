// `puckloop import FILE -o OUT`: another simulator's experiment file as a scenario.

#include "scenarios/argos/import.h"
#include "base/error.h"
#include "scenarios/argos/toml_tree.h"
#include "scenarios/reader/read_scenario.h"
#include "tools/cli/check.h"
#include "tools/cli/command.h"
#include "tools/commands.h"
#include "tools/files/text_files.h"

#include <fmt/format.h>

#include <memory>
#include <string>

namespace puckloop::tools {

namespace {

struct ImportOptions {
    std::string file;
    std::string out = "-";
    scenarios::Settings settings;
};

void import(const ImportOptions& options) {
    if (!argos::is_experiment(options.file))
        throw InputError(options.file, "", "is no ARGoS experiment by its name",
                         "a file whose name ends in .argos or .xml");
    // Whatever a run would refuse is refused here: overlaps, places, images.
    scenarios::read_scenario(options.file, options.settings);
    const argos::Imported imported =
        argos::import_experiment(options.file, {options.settings.floor, options.settings.floor_scale});
    std::string text = fmt::format("# From {}. Not taken over, or otherwise here:\n", options.file);
    if (imported.notes.empty()) text = fmt::format("# From {}, all of it.\n", options.file);
    for (const argos::Note& note : imported.notes) {
        text += fmt::format("# line {}: {}\n", note.line, note.text);
        fmt::print(stderr, "{}: line {}: {}\n", options.file, note.line, note.text);
    }
    write_text(options.out, text + "\n" + argos::toml_text(imported.scenario));
}

}  // namespace

void declare_import(Command& app, int& status) {
    auto options = std::make_shared<ImportOptions>();
    Command* command = app.add_subcommand("import", "an ARGoS experiment file (.argos) as a scenario");
    command->add_option("file", options->file, "experiment file (docs/swarm.md)")
        ->required()
        ->type_name("FILE");
    command->add_option("-o,--out", options->out, "the scenario (default: -, the standard output)")
        ->check(not_empty())
        ->type_name("SCENARIO");
    command->add_option("--floor", options->settings.floor, "PNG file for the floor")
        ->check(not_empty())
        ->type_name("FILE");
    command
        ->add_option("--floor-scale", options->settings.floor_scale,
                     "pixels a metre of --floor (default: it covers the arena)")
        ->check(positive_number())
        ->type_name("N");
    command->callback([options, &status] {
        import(*options);
        status = 0;
    });
}

}  // namespace puckloop::tools
