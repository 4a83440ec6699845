// `puckloop schema NAME`: JSON Schemas, for editors and programs.

#include "tools/guide/schema/schemas.h"

#include "tools/cli/check.h"
#include "tools/cli/command.h"
#include "tools/guide/guide.h"

#include <fmt/format.h>

#include <memory>
#include <string>

namespace puckloop::tools {

void declare_schema(Command& app, int& status) {
    auto name = std::make_shared<std::string>();
    Command* command = app.add_subcommand("schema", "JSON Schema of a scenario, a campaign or a report");
    command->add_option("name", *name, "which one")
        ->required()
        ->check(one_of({"scenario", "campaign", "report"}))
        ->type_name("scenario|campaign|report");
    command->footer("Editors with TOML support complete and check a file whose first line names its schema:\n"
                    "  puckloop schema scenario > scenario.schema.json\n"
                    "  #:schema ./scenario.schema.json");
    command->callback([name, &status] {
        const auto schema = *name == "scenario"   ? scenario_schema()
                            : *name == "campaign" ? campaign_schema()
                                                  : report_schema();
        fmt::print("{}\n", schema.dump(2));
        status = 0;
    });
}

}  // namespace puckloop::tools
