#include "tools/guide/schema/schema_kit.h"
#include "tools/guide/schema/schemas.h"

namespace puckloop::tools {

namespace {

using nlohmann::ordered_json;

ordered_json of(const char* type, const char* about) {
    return {{"type", type}, {"description", about}};
}

ordered_json or_null(const char* type, const char* about) {
    return {{"type", {type, "null"}}, {"description", about}};
}

ordered_json file_schema() {
    return {{"type", "object"},
            {"properties",
             {{"node", of("string", "that uses it")},
              {"role", {{"enum", {"firmware", "program", "flashed"}}}},
              {"file", of("string", "its path")},
              {"sha256", or_null("string", "of its bytes; null: it could not be read")}}},
            {"required", {"node", "role", "file", "sha256"}}};
}

}  // namespace

ordered_json report_schema() {
    ordered_json schema = schema_head("report", "report.json of a puckloop run (docs/scenario.md)");
    schema["type"] = "object";
    ordered_json& p = schema["properties"];
    p["format"] = {{"const", 1},
                   {"description", "version of this format; a key may be added without a new one"}};
    p["puckloop"] = {
        {"type", "object"},
        {"properties",
         {{"version", of("string", "CMake's number")},
          {"commit", of("string", "12 hexadecimal digits; empty: built outside of a repository")},
          {"modified", of("boolean", "tracked sources differed from the commit")}}},
        {"required", {"version", "commit", "modified"}}};
    p["command_line"] = {{"type", "array"}, {"items", {{"type", "string"}}}};
    p["scenario"] = of("string", "its file");
    p["scenario_sha256"] = of("string", "of its file, as it was read");
    p["files"] = {{"type", "array"}, {"items", file_schema()}};
    p["seed"] = of("integer", "of every random stream");
    p["success"] = of("boolean", "the exit status is 0");
    p["ended_by"] = {{"enum", {"duration", "node stopped", "interrupted", "failed"}}};
    p["ended_why"] = of("string", "one line; of a run that failed, why");
    p["failures"] = {{"type", "array"},
                     {"description", "what went wrong although the run went on to its end"},
                     {"items",
                      {{"type", "object"},
                       {"properties",
                        {{"node", of("string", "")},
                         {"kind", {{"enum", {"program", "silent_line", "hung", "expectation"}}}},
                         {"text", of("string", "")},
                         {"allowed", of("boolean", "by the scenario's `allow`")}}},
                       {"required", {"node", "kind", "text", "allowed"}}}}};
    p["expectations"] = {{"type", "array"},
                         {"description", "what the scenario's [[expect]] tables came to (docs/expect.md)"},
                         {"items",
                          {{"type", "object"},
                           {"properties",
                            {{"name", of("string", "what was expected")},
                             {"met", of("boolean", "")},
                             {"why", of("string", "what was seen, or that it was not")},
                             {"at_s", or_null("number", "when it was first seen")}}},
                           {"required", {"name", "met", "why", "at_s"}}}}};
    p["programs_asked_to_end_s"] = or_null("number", "simulated time");
    p["simulated_s"] = of("number", "");
    p["wall_s"] = of("number", "");
    p["real_time_factor"] = of("number", "");
    p["trace_sha256"] = of("string", "of the whole trace; the same for the same run");
    p["grants"] = of("integer", "depends on placement and load");
    p["nodes"] = of("object", "by name: counters and findings of each node");
    p["links"] = of("object", "by name: counters of each direction");
    p["faults"] = ordered_json{{"description", "what each fault did"}};
    p["events"] = ordered_json{{"description", "what happened to the world"}};
    p["warnings"] = {{"type", "array"}, {"items", {{"type", "string"}}}};
    p["unmodelled_registers"] = of("array", "registers without a model that firmware touched");
    p["mission"] = {
        {"type", "object"},
        {"description", "score of the run by the scenario's [mission] (docs/swarm.md)"},
        {"properties",
         {{"kind", of("string", "aggregation, shelter, foraging, coverage, grid_exploration or program")},
          {"score", or_null("number", "null: no step was counted, or no robot")},
          {"better", {{"enum", {"more", "less"}}}},
          {"steps", of("integer", "that were counted; of a program: frames that it got")},
          {"step_s", of("number", "length of a step; not of a program")},
          {"why", of("string", "why there is no score, or what the program did wrong")}}},
        {"required", {"kind", "score", "better", "steps"}}};
    p["from"] = of("object", "the snapshot that the run went on from");
    p["joined_ports"] = {{"type", "array"}, {"items", {{"type", "integer"}}}};
    p["cache_unused"] = of("string", "why no boot was taken from the cache");
    schema["required"] = {"format",       "puckloop", "command_line", "scenario", "files",       "seed",
                          "success",      "ended_by", "ended_why",    "failures", "simulated_s", "wall_s",
                          "trace_sha256", "nodes",    "links",        "warnings"};
    return schema;
}

}  // namespace puckloop::tools
