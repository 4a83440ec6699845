// `puckloop view OUT`: a recorded run as a page in the browser, or as one file.

#include "tools/viewer/view.h"
#include "base/error.h"
#include "tools/cli/check.h"
#include "tools/cli/command.h"
#include "tools/cli/other_programs.h"
#include "tools/shell/client_run.h"
#include "tools/viewer/film.h"
#include "tools/viewer/run_pages.h"
#include "tools/viewer/serve.h"
#include "traces/recorded_trace.h"
#include "view/answers.h"
#include "view/export_page.h"
#include "view/live/control_client.h"
#include "view/server/http_server.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::tools {

namespace {

struct ViewOptions {
    std::string folder, file, size;
    int port = 0;
    pid_t run_process = 0;                 ///< the child of this process that is the run; 0: none
    std::optional<double> picture_at, at;  // s
    FilmOptions film;
};

bool is_film(const std::string& file) {
    return file.ends_with(".mp4") || file.ends_with(".webm");
}

/// "1400x900".
void take_size(const std::string& text, FilmOptions& film) {
    constexpr int kLeast = 200, kMost = 8000;
    const char* const end = text.data() + text.size();
    const auto [middle, first] = std::from_chars(text.data(), end, film.width);
    const bool separated = first == std::errc() && middle != end && *middle == 'x';
    const auto [rest, second] = separated ? std::from_chars(middle + 1, end, film.height)
                                          : std::from_chars_result{middle, std::errc::invalid_argument};
    const auto fits = [](int pixels) { return pixels >= kLeast && pixels <= kMost; };
    if (second != std::errc() || rest != end || !fits(film.width) || !fits(film.height))
        throw InputError("", "--size", fmt::format("'{}' is no size", text),
                         "pixels, 200 to 8000 each, such as 1400x900");
}

/// What is asked for goes with the file that it is for.
void check_export(ViewOptions& options, const std::vector<std::string>& given) {
    if (options.picture_at && options.file.empty())
        options.file =
            std::filesystem::absolute(options.folder).lexically_normal().filename().string() + ".png";
    const bool picture = options.file.ends_with(".png"), film = is_film(options.file);
    if (options.picture_at && !picture)
        throw InputError("", "--png", fmt::format("'{}' is no file of a picture", options.file),
                         "--export with a name that ends with .png, or none");
    if (!options.file.empty() && options.file != "-" && !picture && !film &&
        !options.file.ends_with(".html") && !options.file.ends_with(".htm"))
        throw InputError("", "--export", fmt::format("'{}' is of no kind that is written", options.file),
                         "a name that ends with .html, .png, .mp4 or .webm");
    if (picture && !options.picture_at)
        throw InputError("", "--export", "it is not clear at which time", "--png TIME with it");
    for (const std::string& option : given) {
        const bool of_both = option == "--part" || option == "--size" || option == "--dark";
        if (of_both ? !picture && !film : !film)
            throw InputError("", option, fmt::format("does not go with '{}'", options.file),
                             of_both ? "--png TIME, or --export with .mp4 or .webm"
                                     : "--export with .mp4 or .webm");
    }
    if (!options.size.empty()) take_size(options.size, options.film);
    options.film.file = options.file;
    if (options.picture_at) options.film.begin = *options.picture_at;
}

void export_file(const view::Recording& recording, const std::string& file) {
    check_output_file(file);
    view::EventReader events(recording);
    const std::string page = view::exported_page(recording, events);
    write_output(file, [&](std::ostream& out) { out << page; });
    if (file != "-") fmt::print("{}: {:.1f} MB\n", file, static_cast<double>(page.size()) * 1e-6);
}

void serve(const view::Recording& recording, int port, std::optional<double> at) {
    const view::EventReader events(recording);
    const view::Answers answers(recording, events);
    view::HttpServer server(static_cast<std::uint16_t>(port),
                            [&](std::string_view target) { return answers.get(target); });
    serve_until_interrupted(server, at ? fmt::format("?t={:g}", *at) : std::string());
}

/// A campaign's or an experiment's report, and the pages of its runs.
void serve_runs(ManyRuns runs, const ViewOptions& options) {
    if (!options.file.empty() || options.at)
        throw InputError(
            options.folder, options.at ? "--at" : "--export",
            fmt::format("it has many runs, and this is for one {}", runs.what),
            fmt::format("the folder of a {0}, such as {1}", runs.what,
                        runs.runs.empty() ? "replay/1" : runs.folder(*runs.runs.begin()).string()));
    RunPages pages(std::move(runs));
    view::HttpServer server(static_cast<std::uint16_t>(options.port),
                            [&](std::string_view target) { return pages.get(target); });
    serve_until_interrupted(server);
}

}  // namespace

void declare_view(Command& app, int& status) {
    constexpr int kMostPort = 65535;
    constexpr double kLongest = 9e6, kSlowest = 0.001, kFastest = 1000, kFewest = 1, kMostRate = 120;
    auto options = std::make_shared<ViewOptions>();
    Command* command = app.add_subcommand("view", about("view"));
    command->add_option("folder", options->folder, "results folder of a run, a campaign or an experiment")
        ->required()
        ->type_name("DIR");
    command
        ->add_option("--export", options->file,
                     "write one file, and end: .html (the page with all its data; - is the standard output), "
                     ".mp4 or .webm (a film, by Chromium and ffmpeg)")
        ->check(not_empty())
        ->type_name("FILE");
    command->add_option("--port", options->port, "port on 127.0.0.1; 0 (default): one that is free")
        ->check(whole_number_between(0, kMostPort))
        ->type_name("N");
    command->add_option("--run-process", options->run_process)->group("");  // `run --view` became this
    command->add_option("--at", options->at, "the page begins at this time (s)")
        ->check(number_between(0, kLongest))
        ->type_name("TIME");
    command
        ->add_option(
            "--png", options->picture_at,
            "write a picture of the page at this time (s), by Chromium; into --export FILE.png or NAME.png")
        ->check(number_between(0, kLongest))
        ->type_name("TIME");
    command->add_option("--part", options->film.part, "of the page: page (default), arena or timeline")
        ->check(one_of({"page", "arena", "timeline"}))
        ->type_name("PART");
    command->add_option("--size", options->size, "of the page in pixels; 1400x900 by default")
        ->type_name("WIDTHxHEIGHT");
    command->add_flag("--dark", options->film.dark, "light on dark");
    command->add_option("--begin", options->film.begin, "of a film (s); 0 by default")
        ->check(number_between(0, kLongest))
        ->type_name("TIME");
    command->add_option("--end", options->film.end, "of a film (s); the run's by default")
        ->check(number_between(0, kLongest))
        ->type_name("TIME");
    command->add_option("--speed", options->film.speed, "of a film, times real time; 1 by default")
        ->check(number_between(kSlowest, kFastest))
        ->type_name("X");
    command->add_option("--fps", options->film.rate, "pictures a second of a film; 30 by default")
        ->check(number_between(kFewest, kMostRate))
        ->type_name("N");
    command->footer("Examples:\n"
                    "  puckloop view out/hello                     # prints the address to open\n"
                    "  puckloop view out/hello --at 12.5\n"
                    "  puckloop view out/own                       # a campaign's report, with its cases\n"
                    "  puckloop view out/hello --export hello.html # one file to keep or to mail\n"
                    "  puckloop view out/hello --png 12.5          # a picture, hello.png\n"
                    "  puckloop view out/hello --export hello.mp4 --part arena --speed 4\n");
    command->callback([options, command, &status] {
        if (options->run_process > 0) {
            status = with_child_run(options->run_process, [&] {
                serve_live(options->folder, options->port, true);
                return 0;
            });
            return;
        }
        std::vector<std::string> given;
        for (const char* option : {"--part", "--size", "--dark", "--begin", "--end", "--speed", "--fps"})
            if (command->count(option) > 0) given.emplace_back(option);
        check_export(*options, given);
        if (view::ControlClient::is_there(options->folder)) {
            if (options->at)
                throw InputError(options->folder, "--at", "its run goes on", "the end of the run");
            if (!options->file.empty())
                throw InputError(options->folder, "--export", "its run goes on", "the end of the run");
            return serve_live(options->folder, options->port);
        }
        if (auto runs = many_runs(options->folder)) return serve_runs(std::move(*runs), *options);
        if (options->at && !options->file.empty())
            throw InputError("", "--at", "is for the page in the browser", "--begin of a film, --png TIME");
        const view::Recording recording(options->folder);
        for (const std::string& note : recording.notes())
            fmt::print(stderr, "puckloop: {}: {}\n", options->folder, note);
        if (options->file.empty()) return serve(recording, options->port, options->at);
        if (!is_film(options->file) && !options->picture_at) return export_file(recording, options->file);
        check_output_file(options->file);
        write_film(recording, options->film);
        fmt::print("{}\n", options->file);
    });
}

}  // namespace puckloop::tools
