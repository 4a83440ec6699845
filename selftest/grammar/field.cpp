#include "selftest/grammar/field.h"

#include "physics/description/robot_constants.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string_view>

namespace puckloop::gap::selftest::grammar {

namespace {

constexpr std::array<std::string_view, 7> kNumbering{"sensor", "mic",     "receiver", "object",
                                                     "seq",    "session", "senders"};
constexpr std::array<std::string_view, 14> kMeasured{
    "reading", "level",    "ax",       "ay",       "az",      "strength",        "bearing_rad",
    "light",   "received", "t_host_s", "frame_ok", "shifted", "ambient_reading", "neighbour_reading"};
constexpr double kLeastActive = 0.03;  // share of rows that an effect has to touch

template <class Names>
bool among(const Names& names, std::string_view name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

Rows shaped_like(const WrittenExperiment& exact) {
    Rows rows;
    for (const WrittenRun& run : exact.runs)
        rows.emplace_back(run.rows(), 0.0);
    return rows;
}

/// Divides by the largest size; false where nothing varies.
bool scaled(Rows& rows) {
    double low = INFINITY, high = -INFINITY;
    for (const auto& run : rows)
        for (const double v : run) {
            low = std::min(low, v);
            high = std::max(high, v);
        }
    const double size = std::max(std::abs(low), std::abs(high));
    if (!(high - low > 1e-9 * size)) return false;
    for (auto& run : rows)
        for (double& v : run)
            v /= size;
    return true;
}

void add_drive(const WrittenExperiment& exact, std::vector<Covariate>& list) {
    std::array<Covariate, 7> made{{{"speed", {}},
                                   {"turn rate", {}},
                                   {"acceleration", {}},
                                   {"way driven", {}},
                                   {"left wheel's angle", {}},
                                   {"right wheel's angle", {}},
                                   {"heading", {}}}};
    for (auto& one : made)
        one.value = shaped_like(exact);
    for (std::size_t r = 0; r < exact.runs.size(); ++r) {
        const auto& run = exact.runs[r];
        const auto &x = run.find("x_m")->values, &y = run.find("y_m")->values,
                   &h = run.find("theta_rad")->values;
        // Without counters the wheels' angles are not known.
        const WrittenColumn *left = run.find("steps_left"), *right = run.find("steps_right");
        for (std::size_t k = 1; k < x.size(); ++k) {
            const double dx = x[k] - x[k - 1], dy = y[k] - y[k - 1];
            made[0].value[r][k] = dx * std::cos(h[k]) + dy * std::sin(h[k]);
            made[1].value[r][k] = h[k] - h[k - 1];
            made[2].value[r][k] = made[0].value[r][k] - made[0].value[r][k - 1];
            made[3].value[r][k] = made[3].value[r][k - 1] + std::hypot(dx, dy);
            if (left != nullptr)
                made[4].value[r][k] = std::remainder(left->values[k] / physics::kStepsPerTurn, 1.0);
            if (right != nullptr)
                made[5].value[r][k] = std::remainder(right->values[k] / physics::kStepsPerTurn, 1.0);
            made[6].value[r][k] = std::remainder(h[k], 2 * std::numbers::pi);
        }
    }
    for (auto& one : made)
        if (scaled(one.value)) list.push_back(std::move(one));
}

/// An elementary function with drawn numbers.
struct Form {
    std::function<double(double)> of;
    std::string text;  ///< with {} for the argument
    bool bends;        ///< rises and falls
};

Form drawn_form(RandomStream& random) {
    const double place = 2 * random.uniform() - 1, width = 0.15 + 0.5 * random.uniform();
    switch (random.below(8)) {
    case 0: {
        const double turns = 0.7 + 3.3 * random.uniform(), phase = random.uniform();
        return {[=](double z) { return std::sin(2 * std::numbers::pi * (turns * z + phase)); },
                fmt::format("sin(2 pi ({:.2f} {{}} + {:.2f}))", turns, phase), true};
    }
    case 1:
        return {[=](double z) { return std::exp(-std::pow((z - place) / width, 2)); },
                fmt::format("bump({{}} at {:.2f}, width {:.2f})", place, width), true};
    case 2: {
        constexpr std::array kPowers{0.5, 1.0, 2.0, 3.0};
        const double power = kPowers[random.below(kPowers.size())];
        return {[=](double z) { return std::copysign(std::pow(std::abs(z), power), z); },
                fmt::format("({{}})^{}", power), false};
    }
    case 3:
        return {[=](double z) { return std::max(0.0, z - place); },
                fmt::format("max(0, {{}} - {:.2f})", place), false};
    case 4:
        return {[=](double z) { return z > place ? 1.0 : 0.0; }, fmt::format("[{{}} > {:.2f}]", place),
                false};
    case 5:
        return {[=](double z) { return std::tanh((z - place) / width); },
                fmt::format("tanh(({{}} - {:.2f})/{:.2f})", place, width), false};
    case 6: {
        const double teeth = 1 + 4 * random.uniform();
        return {[=](double z) { return 2 * (teeth * z - std::floor(teeth * z)) - 1; },
                fmt::format("saw({:.2f} {{}})", teeth), true};
    }
    default:
        return {[=](double z) { return (z - place) * (z - place); }, fmt::format("({{}} - {:.2f})^2", place),
                true};
    }
}

/// The covariate, or what it was two rows before, how fast it changes, or how much it has changed so far.
Covariate drawn_view(const Covariate& covariate, RandomStream& random) {
    const auto view = random.below(8);
    if (view > 2) return covariate;
    Covariate seen{covariate.name, covariate.value};
    constexpr std::array kNames{"before {}", "change of {}", "sum of changes of {}"};
    seen.name = fmt::format(fmt::runtime(kNames[view]), covariate.name);
    for (std::size_t r = 0; r < seen.value.size(); ++r) {
        const auto& from = covariate.value[r];
        double sum = 0.0;
        for (std::size_t k = 0; k < from.size(); ++k) {
            const double change = k == 0 ? 0.0 : from[k] - from[k - 1];
            sum += std::abs(change);
            seen.value[r][k] = view == 0 ? from[k < 2 ? 0 : k - 2] : view == 1 ? change : sum;
        }
    }
    return scaled(seen.value) ? seen : covariate;
}

void multiply(Rows& rows, const Rows& by) {
    for (std::size_t r = 0; r < rows.size(); ++r)
        for (std::size_t k = 0; k < rows[r].size(); ++k)
            rows[r][k] *= by[r][k];
}

/// One factor: one or two forms, one in the other.
void apply_factor(Rows& rows, std::string& text, const std::vector<Covariate>& covariates, bool has_to_bend,
                  RandomStream& random) {
    const Covariate seen = drawn_view(covariates[random.below(covariates.size())], random);
    Form outer = drawn_form(random);
    while (has_to_bend && !outer.bends)
        outer = drawn_form(random);
    std::string argument = seen.name;
    Rows factor = seen.value;
    if (random.uniform() < 0.3) {
        const Form inner = drawn_form(random);
        for (auto& run : factor)
            for (double& z : run)
                z = inner.of(z);
        argument = fmt::format(fmt::runtime(inner.text), argument);
    }
    for (auto& run : factor)
        for (double& z : run)
            z = outer.of(z);
    multiply(rows, factor);
    text += (text.empty() ? "" : " * ") + fmt::format(fmt::runtime(outer.text), argument);
}

void gate_sensors(Rows& rows, std::string& text, const WrittenExperiment& exact, RandomStream& random) {
    const std::string index = index_column(exact);
    if (index.empty()) return;
    std::array<double, 16> weight{};
    for (double& w : weight)
        w = random.uniform() < 0.5 ? 0.0 : 2 * random.uniform() - 1;
    for (std::size_t r = 0; r < rows.size(); ++r) {
        const auto& which = exact.runs[r].find(index)->values;
        for (std::size_t k = 0; k < rows[r].size(); ++k)
            rows[r][k] *= weight[static_cast<std::size_t>(std::max(which[k], 0.0)) % weight.size()];
    }
    text += fmt::format(" for some of {}", index);
}

void gate_runs(Rows& rows, std::string& text, RandomStream& random) {
    for (auto& run : rows) {
        const double weight = random.uniform() < 0.5 ? 0.0 : 2 * random.uniform() - 1;
        for (double& v : run)
            v *= weight;
    }
    text += " in some runs";
}

/// On and off at drawn times: once in a run, or to and fro.
void gate_times(Rows& rows, std::string& text, RandomStream& random) {
    const bool once = random.uniform() < 0.4;
    for (auto& run : rows) {
        bool on = random.uniform() < 0.5;
        const double rate = (once ? 1.0 : 6.0) / std::max<double>(1.0, static_cast<double>(run.size()));
        for (double& v : run) {
            if (random.uniform() < rate) on = !on;
            if (!on) v = 0.0;
        }
    }
    text += once ? " from a moment on" : " on and off";
}

/// To root mean square 1; false where nothing is left to speak of.
bool normalised(Rows& rows) {
    double sum = 0.0, count = 0.0, active = 0.0, mean = 0.0;
    for (const auto& run : rows)
        for (const double v : run) {
            sum += v * v;
            mean += v;
            count += 1;
            active += std::abs(v) > 1e-6 ? 1 : 0;
        }
    if (!(sum > 0) || !std::isfinite(sum) || active < kLeastActive * count) return false;
    const double rms = std::sqrt(sum / count);
    mean /= count;
    if (sum / count - mean * mean < 0.01 * rms * rms) return false;  // constant
    for (auto& run : rows)
        for (double& v : run)
            v /= rms;
    return true;
}

}  // namespace

std::vector<Covariate> covariates_of(const WrittenExperiment& exact) {
    std::vector<Covariate> list;
    for (const WrittenColumn& column : exact.runs.front().columns) {
        const bool level = column.name == "reading" || column.name == "level";
        const bool counts = column.name == "steps_left" || column.name == "steps_right";
        if (among(kNumbering, column.name) || counts || (among(kMeasured, column.name) && !level)) continue;
        Covariate one{level ? "level" : column.name, {}};
        for (const WrittenRun& run : exact.runs) {
            const WrittenColumn* own = run.find(column.name);
            one.value.push_back(own == nullptr ? std::vector<double>(run.rows(), 0.0) : own->values);
            for (double& v : one.value.back())
                if (!std::isfinite(v)) v = 0.0;
        }
        if (scaled(one.value)) list.push_back(std::move(one));
    }
    if (exact.kind == "motion") add_drive(exact, list);
    return list;
}

std::string index_column(const WrittenExperiment& exact) {
    for (const char* name : {"sensor", "mic", "receiver"})
        if (exact.runs.front().find(name) != nullptr) return name;
    return {};
}

Field drawn_field(const WrittenExperiment& exact, const std::vector<Covariate>& covariates,
                  RandomStream& random) {
    for (;;) {
        Field field{shaped_like(exact), {}};
        const int terms = random.uniform() < 0.25 ? 2 : 1;
        for (int term = 0; term < terms; ++term) {
            Rows product = shaped_like(exact);
            for (auto& run : product)
                std::fill(run.begin(), run.end(), 1.0);
            std::string text;
            const auto dice = random.below(4);
            const int factors = dice == 0 ? 1 : dice == 3 ? 3 : 2;
            for (int k = 0; k < factors; ++k)
                apply_factor(product, text, covariates, factors == 1, random);
            for (std::size_t r = 0; r < product.size(); ++r)
                for (std::size_t k = 0; k < product[r].size(); ++k)
                    field.value[r][k] += product[r][k];
            field.text += (field.text.empty() ? "" : " + ") + text;
        }
        if (random.uniform() < 0.35) gate_sensors(field.value, field.text, exact, random);
        if (random.uniform() < 0.25) gate_runs(field.value, field.text, random);
        if (random.uniform() < 0.25) gate_times(field.value, field.text, random);
        if (normalised(field.value)) return field;
    }
}

Field power_of(const Covariate& covariate, double exponent) {
    Field field{covariate.value, fmt::format("{}^{}", covariate.name, exponent)};
    for (auto& run : field.value)
        for (double& z : run)
            z = std::copysign(std::pow(std::abs(z), exponent), z);
    (void)normalised(field.value);
    return field;
}

}  // namespace puckloop::gap::selftest::grammar
