#pragma once
// What the stages of an analysis find, each a piece of the verdict, as plain data. Numbers in SI units unless
// a unit stands beside them.

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace puckloop::gap {

struct FittedParameter {
    std::string name, unit;
    double value = 0.0, low = 0.0, high = 0.0;  ///< 90 % interval
    double neutral = 0.0;                       ///< the simulator's value, without the effect
    bool in_simulator = false;                  ///< `run --model` takes it; otherwise only [measurement]
    std::vector<double> as_likely{};            ///< other single values that fit as well, rising
};

/// A named effect of the catalogue with its evidence.
struct Cause {
    std::string name;                          ///< of the effect: "wheel_scale"
    int number = 0;                            ///< in the catalogue
    std::string title;                         ///< in plain words
    double evidence = 0.0;                     ///< delta BIC against the model without it: > 0 speaks for it
    double score_gain = 0.0;                   ///< held-out log score won, nats over all held-out rows
    double score_low = NAN, score_high = NAN;  ///< 90 % over blocks of runs; NaN of what was not chosen
    std::vector<FittedParameter> parameters;
    std::string sentence;  ///< what it says about this robot, with figures
    std::string form;      ///< whether the data tells its form from its neighbours', in words; empty: it does
};

/// Another explanation that the data does not tell from `instead_of`.
struct Rival {
    Cause cause;
    std::string instead_of;
    double delta_bic = 0.0;    ///< of the cause over this rival: < 6 is a draw
    std::string separated_by;  ///< the experiment that would tell
};

struct Held {
    double before = 0.0, after = 0.0;           ///< rms error of held-out rows, standardised over observables
    double ratio = 1.0, low = 1.0, high = 1.0;  ///< after / before with 90 % interval over runs
    double score_before = 0.0, score_after = 0.0;  ///< mean log score a row, nats
    double score_low = 0.0, score_high = 0.0;      ///< of the difference, 90 %
    int runs = 0, runs_better = 0;
    bool gain = false;  ///< the data shows an improvement
    std::string sentence;

    /// Is no change of the error within its interval? A gain is then one of what readings are likely.
    bool error_may_stay() const { return low <= 1 && high >= 1; }
};

struct HeldObservable {
    std::string name, unit;
    double before = 0.0, after = 0.0, ratio = 1.0, low = 1.0, high = 1.0;
};

/// One line of the evidence table: every effect of the kind that was tried.
struct Tried {
    std::string name;
    int number = 0;
    double delta_bic = 0.0, score_gain = 0.0, p_value = 1.0;
    std::string remark;  ///< why figures are NaN, or "chosen, step 1", "needs column motor_speed", "equals
                         ///< wheel_scale", ...
};

/// One observable row by row; `run` and `row` index Experiment::runs and its tables.
struct Series {
    std::string observable, unit;
    bool events = false;  ///< measured is 0 or 1, simulated a probability
    std::vector<std::uint32_t> run, row;
    std::vector<double> measured, before, after;  ///< simulated before and after the chosen effects
    std::vector<double> scale;                    ///< noise sd after, same unit
    /// What structure tests look at: standardised innovations (autocorrelation taken out); of events what
    /// happened less its probability, over the root mean square of its deviation.
    std::vector<double> innovation_before, innovation_after;
};

/// A structure that is left after the best model.
struct Leftover {
    std::string observable, covariate;
    double p_value = 1.0;  ///< corrected for all tests
    std::string shape;     ///< in words: "rises from -3 to 5 counts over distance 2..8 cm"
};

/// A covariate, or two, over which a free-form correction differs.
struct FreeFormTerm {
    std::string over;                ///< "grey", "course and sensor"
    double share = 0.0;              ///< of the correction's variance
    std::vector<std::string> where;  ///< a cell each: "grey = 0.31"
    std::vector<double> values;      ///< mean correction in each cell, observable's unit
    std::string shape;               ///< in words
};

/// What a correction without a mechanism would say of one observable after the named effects.
struct FreeForm {
    std::string observable, unit;
    double gain = 0.0;    ///< log score it wins on held-out rows, nats; below 0: there is nothing
    double sd = 0.0;      ///< of the gain
    double size = 0.0;    ///< root mean square of the correction, in units of the noise
    bool clear = false;   ///< chance does not make it
    bool wild = false;    ///< of where readings go far astray; not added to the gain of the same rows
    bool bursts = false;  ///< of these: they come together
    std::string shape;    ///< in words
    std::vector<FreeFormTerm> terms;  ///< the largest first
};

struct Suggestion {
    std::string what;  ///< in plain words
    /// Expected information about which rival is true; NaN: the catalogue's advice, which was not computed.
    double bits = 0.0;
    std::vector<std::string> between;
    int rank = 1;  ///< 1: the best; those of one rank are as good as each other
};
inline constexpr double kLeastBits = 0.1;  ///< of one: an experiment that promises less would not tell

/// The experiment performed again on the emulator, without and with the overlay: measured against emulated.
struct RerunObservable {
    std::string name, unit;
    double before = 0.0, after = 0.0;  ///< rms error, or how far apart two distributions are
    /// Where the true robot is known (self test): with it, mean of several performances, and what one more of
    /// them may have; not in gap.json.
    double floor = 0.0, floor_limit = 0.0;
};
struct Rerun {
    bool asked = false;
    std::string not_done;                         ///< why not, in plain words; empty: it was done
    std::size_t runs = 0, of_runs = 0, rows = 0;  ///< performed, of all that could be
    std::vector<RerunObservable> observables;
    std::vector<std::string> left_out;  ///< parameters of the overlay that the emulation could not take

    /// What the figures cannot say: a cause that does not act where it was looked, or acts at random moments.
    std::string caution() const;
};

}  // namespace puckloop::gap
