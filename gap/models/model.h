#pragma once
// A forward model of one kind of experiment: what the simulator says for every row, as a function of named
// parameters. With all parameters neutral it is the simulator as it is, with the experiment's nominal
// numbers. The physical formulas are the simulator's own (physics/), called here without its clockwork:
// docs/gap.md says what the shortcut leaves out, tests hold it to the world model.

#include "gap/data/experiment.h"

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::gap {

/// One measured quantity with everything that does not depend on parameters. Rows of one chain (a run, or one
/// sensor of a run) stand together in order of time.
struct Observable {
    std::string name, unit;
    NoiseKind noise = NoiseKind::Carry;
    Instrument instrument{};
    std::vector<double> y;
    std::vector<std::uint32_t> run, row;
    std::vector<char> starts;  ///< 1: nothing is carried over into this row
    /// By how many rows the one before lies back, missing ones counted (1: next to it); empty: unknown,
    /// all 1.
    std::vector<std::uint32_t> steps;
    std::vector<double> time;  ///< s; empty when unknown
    std::vector<double> gate;  ///< weight of the spectral line in this row; empty: 1
    std::vector<double> turn;  ///< Level: by how much the axes that are summed along turn in this row, rad
    std::vector<double> jolt;  ///< Level: variance that the sum gains for sure, observable's unit squared
    bool steady = false;       ///< Level: nothing that the simulator knows adds errors up
    bool waits = false;        ///< errors are waits, to one side, about a zero that is free in each run
    double fixed_sd = 0.0;  ///< > 0: the noise is this and is not fitted (whole steps of an emulated counter)
    double known_sd = 0.0;  ///< noise that the simulator claims; 0: it claims none
    /// Errors of all rows that what the simulator draws once a run may make: some draws; empty: it draws
    /// none.
    std::vector<std::vector<double>> run_draws{};
};

/// A sum, in which what one row lacks goes on in all rows after it.
inline bool adds_up(const Observable& observable) {
    return observable.noise == NoiseKind::Level;
}

/// What the model says of one observable. Empty vectors stand for the neutral value.
struct Predicted {
    std::vector<double> mean;         ///< of an Event: its probability
    std::vector<double> factor;       ///< noise is this many times larger (1)
    std::vector<double> extra;        ///< noise sd added in quadrature, observable's unit (0)
    std::vector<double> jolt;         ///< Level: variance that the sum gains, observable's unit squared (0)
    std::vector<double> lever;        ///< Level: what a number that no row knows does to the sum, by one (0)
    double lever_sd = 0.0;            ///< of that number, anew in each chain
    std::vector<double> lapse;        ///< probability that the row is a lapse (0)
    std::vector<double> lapse_scale;  ///< sd of a lapse, observable's unit
    std::vector<double> lapse_shift;  ///< mean of a lapse, observable's unit (0)
    bool lapse_both = false;          ///< shifted up or down, equally likely
    std::vector<double> chance;       ///< of the mean, where the reading chose it of several (1)
    double floor = 0.0;               ///< reading 0 means "below this" (dead zone); 0: the instrument's floor
    double ceiling = 0.0;             ///< readings above this, noise included, are cut to it; 0: none are
    double pile = 0.0;                ///< sd of a reading cut to the ceiling, observable's unit
    double line_amplitude = 0.0;      ///< of a spectral line with unknown phase, observable's unit
    double line_frequency = 0.0;      ///< Hz

    bool operator==(const Predicted&) const = default;
};
using Prediction = std::vector<Predicted>;

/// A row's value; `neutral` where there are none.
inline double of_row(const std::vector<double>& values, std::size_t i, double neutral = 0.0) {
    return values.empty() ? neutral : values[i];
}

/// The mean of row `i` as a reading shows it: cut to nothing in a dead zone, to the ceiling above it.
double shown(const Predicted& predicted, std::size_t i);

struct ModelParameter {
    std::string name, unit;
    double neutral = 0.0;
};

/// A parameter of how rows are looked at, not of what the simulator does: every fit moves it, as it does the
/// noise.
struct Nuisance {
    std::size_t index = 0;  ///< in Model::parameters()
    double low = 0.0, high = 0.0, prior_sd = 1.0;
    bool wanders = false;  ///< lets sums wander, but at `high`
};

/// What the wheels are said to have gone in each row, by counters or commands; m by the experiment's nominal
/// numbers.
struct WheelRows {
    std::vector<double> left, right, time;
    double quantum = 0.0;  ///< of a counter; 0: nothing was counted
};

/// A moment of a drive's row in which the wheels were driven.
struct WheelMoment {
    std::uint32_t row = 0;   ///< of the first observable
    double share = 0.0;      ///< of the row that is over at its middle
    double seconds = 0.0;    ///< in which the wheels were driven
    double speed = 0.0;      ///< m/s ahead, as a run's terms know it
    double turn_rate = 0.0;  ///< rad/s
    double travelled = 0.0;  ///< m that the wheels have rolled in the run
};

class Model {
  public:
    virtual ~Model() = default;

    const std::vector<ModelParameter>& parameters() const { return parameters_; }
    const std::vector<Observable>& observables() const { return observables_; }
    const std::vector<Nuisance>& nuisances() const { return nuisances_; }
    std::optional<std::size_t> find(std::string_view name) const;
    /// "proximity.gain*" -> the indices of proximity.gain0, ... that occur in the data.
    std::vector<std::size_t> matching(std::string_view pattern) const;
    std::vector<double> neutral() const;

    /// `values` as parameters(). Reuses the memory of `out`. May run on several threads at a time.
    virtual void predict(const std::vector<double>& values, Prediction& out) const = 0;
    Prediction predicted(const std::vector<double>& values) const;

    /// Where the data itself suggests that a fit of this parameter begins; mostly nowhere.
    virtual std::vector<double> starts(std::string_view) const { return {}; }

    /// Other values of this parameter that rows may be unable to part from `value`: of a period those that
    /// meet the rows alike. To be tried; mostly none.
    virtual std::vector<double> aliases(std::string_view, double) const { return {}; }

    /// Of the rows of the first observable, where it is a drive; else nothing.
    virtual WheelRows wheels(const std::vector<double>&) const { return {}; }

    /// The same rows, each in moments, in order; of nothing but drives.
    virtual std::vector<WheelMoment> wheel_moments(const std::vector<double>&) const { return {}; }

    /// Parameters of the simulator that the model took from the data without fitting them, where they are not
    /// neutral.
    virtual std::map<std::string, double> implied() const { return {}; }

  protected:
    ModelParameter& parameter(std::string_view name) { return parameters_[find(name).value()]; }
    std::size_t add(std::string name, std::string unit, double neutral);
    /// Takes the experiment's nominal numbers over; InputError for one that this kind does not know.
    void apply_nominal(const Experiment& experiment);

    std::vector<ModelParameter> parameters_;
    std::vector<Observable> observables_;
    std::vector<Nuisance> nuisances_;
};

/// From where a drive is looked at. Sums along the robot's own axes show what robots do wherever they are and
/// stand the heading's wander; in the room the tracker's noise adds up to nothing, so that less shows.
enum class MotionView { Robot, Room };

/// `experiment` must outlive the model. InputError if its nominal numbers give no prediction. Kinds other
/// than motion have one view only.
std::unique_ptr<Model> make_model(const Experiment& experiment, MotionView view = MotionView::Robot);

std::unique_ptr<Model> make_proximity_model(const Experiment& experiment);
std::unique_ptr<Model> make_motion_model(const Experiment& experiment, MotionView view);
std::unique_ptr<Model> make_rab_model(const Experiment& experiment);
std::unique_ptr<Model> make_microphone_model(const Experiment& experiment);
std::unique_ptr<Model> make_ground_model(const Experiment& experiment);
std::unique_ptr<Model> make_accelerometer_model(const Experiment& experiment);
std::unique_ptr<Model> make_timing_model(const Experiment& experiment);
/// Of a kind that its user described.
std::unique_ptr<Model> make_described_model(const Experiment& experiment);

}  // namespace puckloop::gap
