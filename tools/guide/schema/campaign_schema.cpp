#include "tools/guide/schema/schema_kit.h"
#include "tools/guide/schema/schemas.h"

namespace puckloop::tools {

namespace {

using nlohmann::ordered_json;

// clang-format off
constexpr SchemaKey kHead[]{
    {"scenario", "text", "path relative to this file"}, {"duration", "time", ""}, {"firmware", "texts", "BOARD=IMAGE; $NAME/... from the environment"},
    {"program", "texts", "in place of the scenario's"}, {"seeds", "any", "list of whole numbers"}, {"cases", "integer", "at most so many; default 2000"},
    {"pairs", "integer", "of faults together"}, {"sample_seed", "integer", "of the choice of cases"}};
constexpr SchemaKey kLimits[]{{"silence", "time", ""}, {"pause", "time", ""}, {"resets", "integer", ""}, {"departure", "length", ""}};
constexpr SchemaKey kMetric[]{
    {"name", "text", ""}, {"robot", "text", "length of its path"}, {"value", "text", "JSON pointer into report.json"},
    {"log", "text", "node whose log is counted"}, {"lines", "text", "that hold this text"}, {"tolerance", "any", "ratio, or length of a path"}};
constexpr SchemaKey kSweep[]{
    {"name", "text", ""}, {"byte", "any", "positions in a record, or \"all\""}, {"record", "any", "records, counted from 0"}, {"after", "time", "where counting begins"}};
constexpr SchemaKey kTimes[]{{"from", "time", ""}, {"to", "time", ""}, {"step", "time", ""}};
// clang-format on

}  // namespace

ordered_json campaign_schema() {
    ordered_json schema = schema_head("campaign", "a puckloop campaign of faults (docs/faults.md)");
    schema.update(table_schema("faults to inject, one run each", {}, {"campaign", "sweep"}));
    ordered_json& properties = schema["properties"];
    properties["campaign"] = table_schema("what is run", kHead, {"scenario"});
    properties["limits"] = table_schema("when a run is not like the nominal one", kLimits);
    properties["metric"] =
        list_schema(table_schema("what counts as mission", kMetric, {"name", "tolerance"}));
    ordered_json sweep = table_schema("a grid of faults", kSweep, {"fault"});
    // Any key of a [[fault]] table, and lists of them in `over`.
    sweep["properties"]["fault"] = fault_schema();
    sweep["properties"]["over"] = {{"type", "object"},
                                   {"additionalProperties", {{"type", "array"}, {"minItems", 1}}}};
    sweep["properties"]["times"] = table_schema("when it begins", kTimes, {"from", "to", "step"});
    properties["sweep"] = list_schema(std::move(sweep));
    return schema;
}

}  // namespace puckloop::tools
