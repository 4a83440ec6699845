// puckloop gap import: a published data set becomes experiment folders.

#include "base/error.h"
#include "gap/importers/importers.h"
#include "tools/cli/check.h"
#include "tools/cli/command.h"
#include "tools/gap/subcommands.h"

#include <fmt/format.h>

#include <memory>

namespace puckloop::tools {

namespace {

struct ImportRequest {
    std::filesystem::path folder, out;
    std::string set;
    bool list = false;
};

void tell_sets() {
    for (const gap::importers::Importer& importer : gap::importers::importers())
        fmt::print("{:<34}{}; recognised by {}\n", importer.name, importer.what, importer.recognised_by);
}

}  // namespace

void declare_gap_import(Command& gap, int& status) {
    Command* command = gap.add_subcommand("import", "Turn a published data set into experiment folders");
    auto request = std::make_shared<ImportRequest>();
    command->add_option("set_folder", request->folder, "folder of the data set")->type_name("SET_FOLDER");
    command->add_option("--out", request->out, "where the experiment folders go")
        ->check(not_empty())
        ->type_name("DIR");
    command->add_option("--set", request->set, "which data set it is, if its files do not tell")
        ->type_name("NAME");
    command->add_flag("--list", request->list, "list the data sets known");
    command->callback([request, &status] {
        status = 0;
        if (request->list) return tell_sets();
        if (request->folder.empty())
            throw InputError("", "", "gap import: no data set", "SET_FOLDER (see gap import --list)");
        if (request->out.empty()) throw InputError("", "", "gap import: nowhere to write", "--out DIR");
        for (const auto& e : gap::importers::import_set(request->folder, request->set, request->out)) {
            std::size_t rows = 0;
            for (const auto& run : e.runs)
                rows += run.columns.empty() ? 0 : run.columns.front().values.size();
            fmt::print("{}: kind {}, {} runs, {} rows\n", (request->out / e.folder).string(), e.kind,
                       e.runs.size(), rows);
        }
    });
}

}  // namespace puckloop::tools
