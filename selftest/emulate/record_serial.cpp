#include "selftest/emulate/record_serial.h"

#include "base/error.h"
#include "base/random.h"
#include "base/text/csv.h"
#include "protocols/serial/epuck_serial.h"

#include <fstream>

namespace puckloop::gap::emulate {

namespace {

constexpr double kAnalyserNoise = 1e-7;  // s
constexpr std::size_t kStartColumn = 6;  // column of a trace: when the start bit begins
constexpr double kApart = 1.5;           // bytes: more is the next answer
constexpr std::size_t kAnswers = 24, kBriefAnswers = 8;
constexpr double kSeconds = 4.0, kBriefSeconds = 1.5;

/// Start bits on the main board's line, s.
std::vector<double> start_bits(const std::filesystem::path& trace) {
    std::ifstream in(trace);
    std::string line;
    std::vector<double> times;
    while (std::getline(in, line)) {
        if (line.find(",robot0.uart,robot0.pic,uart,") == std::string::npos) continue;
        (void)csv_number(csv_cells(line, ',').at(kStartColumn), times.emplace_back());
    }
    return times;
}

}  // namespace

std::vector<SerialAnswer> serial_answers(const std::filesystem::path& trace) {
    const auto times = start_bits(trace);
    std::vector<SerialAnswer> answers;
    for (std::size_t i = 0; i < times.size();) {
        SerialAnswer answer{0.0};
        const double first = times[i];
        for (++i; i < times.size() && times[i] - times[i - 1] < kApart * kSerialByte; ++i)
            answer.push_back(times[i] - first);
        if (answer.size() == protocols::kEpuckSensorBytes) answers.push_back(std::move(answer));
    }
    return answers;
}

WrittenExperiment record_serial(const RecordOptions& options) {
    Act act;
    act.arena = "[arena]\nsize = [\"2 m\", \"2 m\"]\n";
    act.commands = {{0, 0, 0}, {options.brief ? kBriefSeconds : kSeconds, 0, 0}};
    (void)perform(options.robot, act, options.tools, options.seed, options.scratch);
    const auto answers = serial_answers(options.scratch / "out" / "trace.csv");
    const std::size_t wanted = options.brief ? kBriefAnswers : kAnswers;
    if (answers.size() < wanted) throw RunError("too few whole answers on the serial line");
    RandomStream noise(options.seed, "logic analyser");
    WrittenExperiment experiment;
    experiment.kind = "timing";
    for (std::size_t r = 0; r < wanted; ++r) {
        WrittenRun run;
        for (std::size_t k = 0; k < answers[r].size(); ++k) {
            const auto number = static_cast<double>(k);
            run.column("seq").values.push_back(number);
            run.column("t_robot_s", "s").values.push_back(number * kSerialByte);
            run.column("t_host_s", "s").values.push_back(answers[r][k] + kAnalyserNoise * noise.normal());
            run.column("nominal_period", "s").values.push_back(kSerialByte);
        }
        experiment.runs.push_back(std::move(run));
    }
    return experiment;
}

}  // namespace puckloop::gap::emulate
