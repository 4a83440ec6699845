// `puckloop act RUN COMMAND`: does something to the world of a run that is on.

#include "base/error.h"
#include "base/json.h"
#include "run/control/control_place.h"
#include "run/control/control_socket.h"
#include "scenarios/reader/events/action_forms.h"
#include "scenarios/reader/events/event_tables.h"
#include "tools/cli/command.h"
#include "tools/commands.h"

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <numbers>

namespace puckloop::tools {

namespace {

constexpr double kPatience = 10.0;  // s of wall-clock time
constexpr const char* kList = "list";

struct ActOptions {
    std::string run;
    std::vector<std::string> words;
    bool json = false;
};

std::string verbs() {
    std::string text;
    for (const auto& form : scenarios::action_forms())
        text += fmt::format("  {}\n      {}\n", form.usage, form.help);
    return text;
}

void print_list(const nlohmann::json& reply) {
    fmt::print("at {:.3f} s\n{:<12} {:<20} {:>9} {:>9} {:>9}\n", reply.at("at_s").get<double>(), "", "",
               "x cm", "y cm", "heading");
    constexpr double kCentimetres = 100, kDegrees = 180 / std::numbers::pi;
    for (const auto& one : reply.at("list")) {
        const double turn = std::remainder(one.at("theta_rad").get<double>(), 2 * std::numbers::pi);
        fmt::print("{:<12} {:<20} {:>9.2f} {:>9.2f} {:>9.2f}{}\n", one.at("kind").get<std::string>(),
                   one.at("name").get<std::string>(), one.at("x_m").get<double>() * kCentimetres + 0.0,
                   one.at("y_m").get<double>() * kCentimetres + 0.0, turn * kDegrees + 0.0,
                   one.value("lifted", false) ? "  lifted" : "");
    }
    fmt::print("commands:\n{}", verbs());
}

void act(const ActOptions& options) {
    std::string text;
    for (const std::string& word : options.words)
        text += (text.empty() ? "" : " ") + word;
    const bool list = text == kList;
    if (!list) scenarios::parse_command(text);  // refused before anybody is asked
    const nlohmann::json request = list ? nlohmann::json{{"list", true}} : nlohmann::json{{"act", text}};
    const std::string socket = control_path_of(options.run);
    const std::string answer = ask(options.run, socket, request.dump() + "\n", kPatience);
    const auto reply = nlohmann::json::parse(answer, nullptr, false);
    if (!reply.is_object()) throw RunError(fmt::format("{}: a reply that is none", options.run));
    if (reply.contains("refused")) throw InputError("", options.run, reply.value("refused", ""));
    if (options.json)
        fmt::print("{}\n", reply.dump());
    else if (list)
        print_list(reply);
    else
        fmt::print("{:.3f} s: {}\n", reply.value("at_s", 0.0), reply.value("done", ""));
}

}  // namespace

void declare_act(Command& app, int& status) {
    auto options = std::make_shared<ActOptions>();
    Command* command = app.add_subcommand(
        "act", "do something to the world of a run that is on (run --realtime or --paced)");
    command->footer("Commands, as [[event]] tables of a scenario have them (docs/scenario.md):\n" + verbs() +
                    "  list\n      what is in the world now, and this list\n");
    command->add_option("run", options->run, "results folder, or its name in out/")
        ->required()
        ->type_name("RUN");
    command->add_option("command", options->words, "in quotes: \"move can to 10 cm, 0 cm\", or list")
        ->required()
        ->type_name("COMMAND");
    command->add_flag("--json", options->json, "print the reply as JSON");
    command->callback([options, &status] {
        act(*options);
        status = 0;
    });
}

}  // namespace puckloop::tools
