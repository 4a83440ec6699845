// `puckloop bench sound`: published experiments with sound, repeated on emulated boards.

#include "tools/bench/sound.h"
#include "base/error.h"
#include "base/files/claimed_folder.h"
#include "base/files/text_file.h"
#include "reproductions/ears_radio.h"
#include "reproductions/exchange_boards.h"
#include "reproductions/pictures.h"
#include "tools/cli/check.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

namespace puckloop::tools {

namespace {

constexpr double kSquareCentimetres = 1e4, kDegrees = 180 / std::numbers::pi, kMillimetres = 1000;

struct SoundCommandOptions {
    SoundOptions sound;
    std::filesystem::path radio;
    std::vector<std::string> experiments;
    std::filesystem::path out = "out/sound";
};

bool wanted(const SoundCommandOptions& options, const char* name) {
    return options.experiments.empty() || std::find(options.experiments.begin(), options.experiments.end(),
                                                    name) != options.experiments.end();
}

std::string caption(const SoundOptions& sound) {
    return fmt::format("{}, median and 80 % of {} trials", sound.firmware.filename().string(), sound.trials);
}

void print_bins(const Readings& readings, double width, double scale, const char* unit) {
    for (const Bin& bin : binned(readings, width))
        fmt::print("  {:6.0f} {}  {:5.0f}  ({:.0f} to {:.0f})\n", bin.at * scale, unit, bin.median, bin.p10,
                   bin.p90);
}

std::string shape_of(const std::vector<std::pair<double, double>>& places) {
    const auto fit = fit_ellipse(places);
    if (!fit) return "too few for an ellipse";
    return fmt::format("ellipse of {:.0f} cm2, half axes {:.0f} and {:.0f} mm, at {:.0f} degrees",
                       fit->area() * kSquareCentimetres, fit->major * kMillimetres, fit->minor * kMillimetres,
                       fit->angle * kDegrees);
}

void run_ears(const SoundCommandOptions& options, const TrialProgress& progress) {
    const Ears ears = ears_and_radio(options.sound, progress);
    write_file(options.out / "ears.csv", heard_csv(ears));
    std::vector<std::pair<double, double>> places;
    for (const Heard& one : ears.heard)
        places.emplace_back(one.x, one.y);
    const std::string summary = fmt::format(
        "heard {} times in {} calls (published: 58 on robots, 65 in Webots)", ears.heard.size(), ears.calls);
    write_file(options.out / "ears.svg", ears_picture(ears, summary));
    fmt::print("ears and radio, {:g} s: {}; {}\n", options.sound.walk_s, summary, shape_of(places));
}

void run_radio(const SoundCommandOptions& options) {
    SoundOptions sound = options.sound;
    sound.walker = options.radio;
    const EarsRadio ears = ears_with_radio(sound);
    write_file(options.out / "radio.csv", ears_radio_csv(ears));
    std::vector<std::pair<double, double>> places;
    std::vector<ReportedExchange> exchanges;
    for (const RadioAttempt& one : ears.attempts) {
        places.emplace_back(one.heard.x, one.heard.y);
        exchanges.push_back(one.exchange);
    }
    const ExchangeTimes times = times_of(exchanges);
    const std::string summary =
        fmt::format("heard {} times in {:.0f} s of walking, {} messages arrived (published: 58, 53)",
                    times.attempts, ears.walked, ears.messages);
    write_file(options.out / "radio.svg", ears_radio_picture(ears, summary));
    write_file(options.out / "radio_times.svg", exchange_picture(times, sound.walker.filename().string()));
    fmt::print("ears and radio by Bluetooth, {:.0f} s with its pauses: {}; {}\n{}", ears.lasted, summary,
               shape_of(places), exchange_table(times, sound.walker.filename().string()));
}

void run_sound(SoundCommandOptions& options, int& status) {
    SoundOptions& sound = options.sound;
    const bool with_radio =
        wanted(options, "radio") && !(options.experiments.empty() && options.radio.empty());
    if (with_radio && options.radio.empty())
        throw InputError("", "--experiment radio", "its robots need a program", "--radio IMAGE");
    const bool others = wanted(options, "distance") || wanted(options, "calls") || wanted(options, "ears");
    if (others && sound.firmware.empty())
        throw InputError("", "bench sound", "the robots need a program", "--firmware IMAGE");
    if (sound.walker.empty()) sound.walker = sound.firmware;
    claim_folder(options.out, ".puckloop-bench",
                 {"ears.csv", "ears.svg", "radio.csv", "radio.svg", "radio_times.svg", "distance.csv",
                  "distance.svg", "calls.csv", "calls.svg", "trials"});
    sound.folder = options.out / "trials";
    const bool terminal = ::isatty(STDERR_FILENO) == 1;
    const TrialProgress progress = [terminal](int trial, int trials) {
        if (terminal) fmt::print(stderr, "\rtrial {} of {} ", trial + 1, trials);
    };
    if (wanted(options, "distance")) {
        const Readings readings = sound_against_distance(sound, progress);
        write_file(options.out / "distance.csv", readings_csv(readings, "distance_m"));
        write_file(options.out / "distance.svg", distance_picture(readings, caption(sound)));
        fmt::print("sound 1 against distance (mean of three volumes, counts):\n");
        print_bins(readings, 0.025, kMillimetres, "mm");
    }
    if (wanted(options, "calls")) {
        const Readings readings = five_sounds(sound, progress);
        write_file(options.out / "calls.csv", readings_csv(readings, "t_s"));
        write_file(options.out / "calls.svg", calls_picture(readings, caption(sound)));
        fmt::print("five sounds in a row, 10 cm apart: {}\n", (options.out / "calls.svg").string());
    }
    if (wanted(options, "ears")) run_ears(options, progress);
    if (with_radio) run_radio(options);
    fmt::print("{}\n", options.out.string());
    status = 0;
}

}  // namespace

void declare_bench_sound(Command& bench, int& status) {
    Command* command = bench.add_subcommand(
        "sound", "published experiments with sound between robots, as pictures and tables (docs/sound.md)");
    auto options = std::make_shared<SoundCommandOptions>();
    SoundOptions& sound = options->sound;
    command
        ->add_option("--firmware", sound.firmware,
                     "image that answers BTcom's commands T, U and D on UART1, such as "
                     "firmware/sound/sound.hex")
        ->type_name("IMAGE");
    command
        ->add_option("--walker", sound.walker,
                     "of ears: image that at selector 2 walks and writes a line when it hears (default: "
                     "--firmware)")
        ->type_name("IMAGE");
    command
        ->add_option(
            "--radio", options->radio,
            "of radio: image that calls at selector 0 and at 1 walks, hears and sends by Bluetooth, such "
            "as firmware/ears/ears.hex")
        ->type_name("IMAGE");
    command
        ->add_option("--experiment", options->experiments,
                     "distance, calls, ears or radio (repeatable; default all that have their image)")
        ->allow_extra_args(false)
        ->check(one_of({"distance", "calls", "ears", "radio"}));
    command->add_option("--trials", sound.trials, "of distance and calls (default 10)")
        ->check(whole_number_between(1, 1000))
        ->type_name("N");
    command
        ->add_option("--walk", sound.walk_s,
                     "how long ears lasts, and radio without its pauses (default 360)")
        ->check(number_between(1, 36000))
        ->type_name("S");
    command->add_option("--seed", sound.seed, "of the trials (default 1)")
        ->check(count_up_to(1'000'000'000))
        ->type_name("N");
    command
        ->add_option("--overlay", sound.overlay,
                     "physical parameters, such as \"microphone.motor_noise\" = 12 (docs/gap.md)")
        ->type_name("OVERLAY");
    command->add_option("--out", options->out, "folder for results (default out/sound)")->type_name("DIR");
    command->callback([options, &status] { run_sound(*options, status); });
}

}  // namespace puckloop::tools
