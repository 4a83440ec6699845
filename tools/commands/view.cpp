// `puckloop view OUT`: a recorded run as a page in the browser, or as one file.

#include "base/error.h"
#include "tools/cli/check.h"
#include "tools/cli/command.h"
#include "tools/commands.h"
#include "tools/viewer/serve.h"
#include "traces/recorded_trace.h"
#include "view/answers.h"
#include "view/export_page.h"
#include "view/live/control_client.h"
#include "view/server/http_server.h"

#include <fmt/format.h>

#include <cstdio>
#include <memory>

namespace puckloop::tools {

namespace {

struct ViewOptions {
    std::string folder, file;
    int port = 0;
};

void export_file(const view::Recording& recording, const std::string& file) {
    check_output_file(file);
    view::EventReader events(recording);
    const std::string page = view::exported_page(recording, events);
    write_output(file, [&](std::ostream& out) { out << page; });
    if (file != "-") fmt::print("{}: {:.1f} MB\n", file, static_cast<double>(page.size()) * 1e-6);
}

void serve(const view::Recording& recording, int port) {
    const view::EventReader events(recording);
    const view::Answers answers(recording, events);
    view::HttpServer server(static_cast<std::uint16_t>(port),
                            [&](std::string_view target) { return answers.get(target); });
    serve_until_interrupted(server);
}

}  // namespace

void declare_view(Command& app, int&) {
    constexpr int kMostPort = 65535;
    auto options = std::make_shared<ViewOptions>();
    Command* command = app.add_subcommand(
        "view", "a recorded run as a page in the browser: arena, timeline, frames, sensors");
    command->add_option("folder", options->folder, "results folder of a run")->required()->type_name("DIR");
    command
        ->add_option("--export", options->file,
                     "write the page with all its data as one HTML file, and end; - is the standard output")
        ->check(not_empty())
        ->type_name("FILE");
    command->add_option("--port", options->port, "port on 127.0.0.1; 0 (default): one that is free")
        ->check(whole_number_between(0, kMostPort))
        ->type_name("N");
    command->footer("Examples:\n"
                    "  puckloop view out/hello                     # prints the address to open\n"
                    "  puckloop view out/hello --export hello.html # one file to keep or to mail\n");
    command->callback([options] {
        if (view::ControlClient::is_there(options->folder)) {
            if (!options->file.empty())
                throw InputError(options->folder, "--export", "its run goes on", "the end of the run");
            return serve_live(options->folder, options->port);
        }
        const view::Recording recording(options->folder);
        for (const std::string& note : recording.notes())
            fmt::print(stderr, "puckloop: {}: {}\n", options->folder, note);
        if (options->file.empty())
            serve(recording, options->port);
        else
            export_file(recording, options->file);
    });
}

}  // namespace puckloop::tools
