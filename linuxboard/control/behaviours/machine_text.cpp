#include "linuxboard/control/behaviours/machine_text.h"

#include <charconv>
#include <cmath>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>

namespace puckloop::control {

namespace {

constexpr int kMostStates = 16;
constexpr int kMostTransitions = 16;
constexpr double kMostSteps = 1000;  // of a turn
constexpr double kMostNeighbours = 255;
constexpr double kMostWeight = 1000;

/// Options with one value each, every one of which has to be asked for.
class Words {
  public:
    explicit Words(std::string_view text) {
        std::istringstream in{std::string(text)};
        for (std::string name, value; in >> name;) {
            if (!name.starts_with("--") || name.size() < 3) fail(name, "an option such as --nstates");
            if (!(in >> value)) fail(name, "a value behind it");
            if (!values_.emplace(name, value).second) fail(name, "it once");
        }
    }
    double number(const std::string& name, double low, double high) {
        const auto found = values_.find(name);
        if (found == values_.end()) fail(name, "it in the machine");
        const std::string& text = found->second;
        double value = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        std::ostringstream range;
        range << "a number, " << low << " to " << high << ", not " << text.substr(0, 40);
        if (error != std::errc() || end != text.data() + text.size() || !(value >= low && value <= high))
            fail(name, range.str());
        used_.insert(name);
        return value;
    }
    int whole(const std::string& name, int low, int high) {
        const double value = number(name, low, high);
        if (value != std::floor(value)) fail(name, "a whole number");
        return static_cast<int>(value);
    }
    void check_all_used() const {
        for (const auto& [name, value] : values_)
            if (!used_.contains(name)) fail(name, "no such option for this machine's states and transitions");
    }
    [[noreturn]] static void fail(const std::string& name, const std::string& expected) {
        throw std::runtime_error(name.substr(0, 40) + ": expected " + expected);
    }

  private:
    std::map<std::string, std::string> values_;
    std::set<std::string> used_;
};

MachineCondition read_condition(Words& words, int state, int number, int states) {
    const std::string place = std::to_string(state) + "x" + std::to_string(number);
    MachineCondition condition;
    const int other = words.whole("--n" + place, 0, states - 2);
    condition.target = other < state ? other : other + 1;
    condition.kind = static_cast<MachineCondition::Kind>(words.whole("--c" + place, 0, 5));
    const bool counts = condition.kind == MachineCondition::Kind::Neighbours ||
                        condition.kind == MachineCondition::Kind::FewNeighbours;
    condition.p = words.number("--p" + place, 0, counts ? kMostNeighbours : 1);
    if (counts) condition.w = words.number("--w" + place, 0, kMostWeight);
    return condition;
}

}  // namespace

std::vector<MachineState> parse_machine(std::string_view text) {
    Words words(text);
    const int count = words.whole("--nstates", 1, kMostStates);
    std::vector<MachineState> states;
    for (int i = 0; i < count; ++i) {
        const std::string place = std::to_string(i);
        MachineState state;
        state.kind = static_cast<MachineState::Kind>(words.whole("--s" + place, 0, 5));
        if (state.kind == MachineState::Kind::Walk)
            state.parameter = words.number("--rwm" + place, 0, kMostSteps);
        if (state.kind == MachineState::Kind::Attraction)
            state.parameter = words.number("--att" + place, 0, kMostWeight);
        if (state.kind == MachineState::Kind::Repulsion)
            state.parameter = words.number("--rep" + place, 0, kMostWeight);
        // A machine of one state may leave its count of transitions away.
        const int transitions = count == 1 ? 0 : words.whole("--n" + place, 0, kMostTransitions);
        for (int j = 0; j < transitions; ++j)
            state.conditions.push_back(read_condition(words, i, j, count));
        states.push_back(std::move(state));
    }
    words.check_all_used();
    return states;
}

}  // namespace puckloop::control
