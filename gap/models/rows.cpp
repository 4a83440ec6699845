#include "gap/models/rows.h"

#include "gap/clean/quantum.h"
#include "gap/kinds/columns.h"
#include "gap/stats/robust.h"
#include "gap/stats/series.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace puckloop::gap {

namespace {
constexpr double kGap = 5.0;      // times the usual step between rows: beyond, nothing is carried over
constexpr double kOffBeat = 0.1;  // of the usual step: nearer to a whole multiple, a row keeps to the beat
// Share of a run's steps that do, at least, if missing rows are counted by time.
constexpr double kOnBeat = 0.9;
constexpr double kMostSteps = 1e6;  // that one row lies behind another: beyond, nothing is carried anyway
}  // namespace

Rows::Rows(const Experiment& experiment, std::string_view chain_by,
           const std::vector<std::string_view>& needed)
    : experiment_(experiment) {
    for (std::size_t r = 0; r < experiment.runs.size(); ++r) {
        const Run& run = experiment.runs[r];
        std::vector<std::uint32_t> rows;
        const auto& key = run.column(chain_by);
        std::vector<std::uint32_t> place(run.rows);
        std::map<double, std::uint32_t> seen;
        for (std::uint32_t i = 0; i < run.rows; ++i) {
            place[i] = seen[key.empty() || std::isnan(key[i]) ? 0.0 : key[i]]++;
            const bool whole = std::ranges::all_of(needed, [&](std::string_view name) {
                const auto& values = run.column(name);
                return !values.empty() && !std::isnan(values[i]);
            });
            if (whole) rows.push_back(i);
        }
        if (!key.empty()) std::ranges::stable_sort(rows, [&](auto a, auto b) { return key[a] < key[b]; });
        for (std::size_t i = 0; i < rows.size(); ++i) {
            run_.push_back(static_cast<std::uint32_t>(r));
            row_.push_back(rows[i]);
            place_.push_back(place[rows[i]]);
            starts_.push_back(i == 0 || (!key.empty() && key[rows[i]] != key[rows[i - 1]]) ? 1 : 0);
        }
    }
}

std::vector<double> Rows::column(std::string_view name, double fallback) const {
    std::vector<double> values(size(), fallback);
    for (std::size_t i = 0; i < size(); ++i) {
        const auto& column = experiment_.runs[run_[i]].column(name);
        if (!column.empty() && !std::isnan(column[row_[i]])) values[i] = column[row_[i]];
    }
    return values;
}

std::vector<Rows::Beat> Rows::beats(const std::vector<double>& time) const {
    std::vector<std::vector<double>> steps(experiment_.runs.size());
    for (std::size_t i = 1; i < size(); ++i)
        if (starts_[i] == 0 && time[i] > time[i - 1]) steps[run_[i]].push_back(time[i] - time[i - 1]);
    std::vector<Beat> beats;
    for (const auto& of_run : steps) {
        Beat& beat = beats.emplace_back();
        if (of_run.empty()) continue;
        beat.usual = stats::upper_median(of_run);
        const auto on = std::ranges::count_if(of_run, [&](double step) {
            return std::abs(std::remainder(step, beat.usual)) < kOffBeat * beat.usual;
        });
        beat.kept = static_cast<double>(on) >= kOnBeat * static_cast<double>(of_run.size());
    }
    return beats;
}

Observable Rows::observable(std::string_view name, NoiseKind noise, std::initializer_list<Wanted> beside,
                            const std::vector<double>& skipped, std::vector<std::uint32_t>* places) const {
    Observable out;
    out.name = name;
    const ColumnInfo* info = find_column(experiment_.kind, name);
    out.unit = info == nullptr ? "" : info->unit;
    out.noise = noise;
    const auto instrument = experiment_.instruments.find(std::string(name));
    const double none = std::numeric_limits<double>::quiet_NaN();
    out.instrument =
        instrument == experiment_.instruments.end() ? Instrument{none, none, 0.0} : instrument->second;
    const std::vector<double> y = column(name, none);
    if (!(out.instrument.quantum > 0) && noise != NoiseKind::Event) out.instrument.quantum = quantum_of(y);
    const std::vector<double> time = column("t_s", none);
    const std::vector<double> number = column("seq", none);
    const std::vector<Beat> beat = beats(time);
    // Rows of the table that were left out are counted; those that the table lacks by a sequence number, or
    // by the beat.
    const auto back = [&](std::size_t before, std::size_t i) {
        double steps = static_cast<double>(place_[i] - place_[before]);
        const double later = time[i] - time[before], further = number[i] - number[before];
        if (further >= steps)
            steps = further;
        else if (beat[run_[i]].kept && later > 0)
            steps = std::max(steps, std::round(later / beat[run_[i]].usual));
        return static_cast<std::uint32_t>(std::min(steps, kMostSteps));
    };
    bool begins = true, timed = true;
    std::vector<std::uint32_t> used;
    for (std::size_t i = 0; i < size(); ++i) {
        if (starts_[i] != 0) begins = true;
        if (std::isnan(y[i]) || (!skipped.empty() && skipped[i] > 0.5)) continue;
        const double most = kGap * beat[run_[i]].usual;
        const bool gap =
            noise != NoiseKind::Level && !used.empty() && most > 0 && time[i] - time[used.back()] > most;
        out.steps.push_back(begins || used.empty() ? 1 : back(used.back(), i));
        used.push_back(static_cast<std::uint32_t>(i));
        out.y.push_back(y[i]);
        out.run.push_back(run_[i]);
        out.row.push_back(row_[i]);
        out.starts.push_back(begins || gap ? 1 : 0);
        out.time.push_back(time[i]);
        timed = timed && !std::isnan(time[i]);
        begins = false;
    }
    if (!timed) out.time.clear();
    for (const Wanted& one : beside)
        one.into = taken(column(one.name, one.fallback), used);
    if (places != nullptr) *places = std::move(used);
    return out;
}

std::vector<double> taken(const std::vector<double>& column, const std::vector<std::uint32_t>& used) {
    std::vector<double> values;
    for (const auto i : used)
        values.push_back(column[i]);
    return values;
}

std::vector<double> distinct(const std::vector<double>& column) {
    std::vector<double> values = stats::finite(column);
    std::ranges::sort(values);
    values.erase(std::unique(values.begin(), values.end()), values.end());
    return values;
}

std::vector<int> whole(const std::vector<double>& column) {
    std::vector<int> numbers;
    for (const double value : column)
        numbers.push_back(static_cast<int>(std::lround(value)));
    return numbers;
}

std::vector<int> in_order_met(const std::vector<int>& numbers) {
    std::vector<int> met;
    for (const int number : numbers)
        if (!stats::contains(met, number)) met.push_back(number);
    return met;
}

}  // namespace puckloop::gap
