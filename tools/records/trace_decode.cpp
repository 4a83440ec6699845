// `puckloop trace decode`: the frames of a run by protocol, errors marked.

#include "base/error.h"
#include "tools/cli/check.h"
#include "tools/cli/command.h"
#include "tools/records/trace_parts.h"
#include "traces/decoders/decode.h"

#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <memory>

namespace puckloop::tools {

namespace {

struct DecodeOptions {
    std::string trace;
    std::vector<std::string> protocols;
    TraceSelection selection;
    bool json = false, errors_only = false;
};

}  // namespace

void declare_trace_decode(Command& trace) {
    auto options = std::make_shared<DecodeOptions>();
    Command* command =
        trace.add_subcommand("decode", "print the frames of a trace by protocol, errors marked");
    command->add_option("trace", options->trace, "results folder of a run, or its trace.csv")
        ->required()
        ->type_name("DIR");
    command
        ->add_option(
            "--protocol", options->protocols,
            "only epuck, xbee, bluetooth, bytes, i2c, can, rab, ircom, mesh, ip or fault (repeatable)")
        ->allow_extra_args(false)
        ->check(one_of({kProtocols.begin(), kProtocols.end()}));
    command->add_flag("--errors", options->errors_only, "only frames with something wrong");
    command->add_flag("--json", options->json, "one JSON object per line");
    add_selection(*command, options->selection);
    command->callback([options] {
        // What a node's frames are depends on the answers of others: the frames are chosen, not the rows.
        options->selection.nodes_only_named = true;
        const auto& nodes = options->selection.nodes;
        const RecordedTrace recorded(options->trace, options->selection);
        write_output("-", [&](std::ostream& out) {
            decode_trace(recorded, [&](const DecodedFrame& frame) {
                const auto& wanted = options->protocols;
                if (!wanted.empty() &&
                    std::find(wanted.begin(), wanted.end(), frame.protocol) == wanted.end())
                    return;
                if (!nodes.empty() && std::find(nodes.begin(), nodes.end(), frame.from) == nodes.end())
                    return;
                if (options->errors_only && frame.errors.empty()) return;
                out << (options->json ? to_json(frame) : to_text(frame)) << '\n';
            });
        });
    });
}

}  // namespace puckloop::tools
