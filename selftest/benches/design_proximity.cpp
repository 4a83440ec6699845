#include "selftest/benches/design_proximity.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

namespace puckloop::gap::selftest {

namespace {

constexpr double kRow = 0.1;    // s between rows
constexpr double kPause = 40;   // s between runs
constexpr double kGrey = 0.45;  // stated reflectivity of the grey wall
constexpr double kLamp = 1.0;   // ambient level
constexpr int kRepeats = 2;
constexpr double kDesignDegree = std::numbers::pi / 180;
constexpr std::array<double, 12> kGaps{2, 4, 7, 10, 14, 18, 24, 31, 40, 52, 66, 90};  // mm
constexpr std::array<std::size_t, 4> kSome{0, 2, 5, 7};

class ProximityPlan {
  public:
    explicit ProximityPlan(RandomStream& random) : random_(random) {}

    void begin(const char* surface, const char* light, const char* motors, double speed) {
        runs_.push_back({{{"surface", surface}, {"light", light}, {"motors", motors}}, {}});
        now_ = {};
        now_.reflectivity = std::string(surface) == "grey" ? kGrey : 1.0;
        now_.ambient = std::string(light) == "lamp" ? kLamp : 0.0;
        now_.motors = speed;
    }
    void read(std::size_t sensor, double gap, double incidence, double closing) {
        now_.t = clock_;
        now_.sensor = sensor;
        now_.gap = gap;
        now_.incidence = incidence;
        now_.closing = closing;
        runs_.back().scenes.push_back(now_);
        clock_ += kRow;
    }
    void end() {
        auto& scenes = runs_.back().scenes;
        for (std::size_t k = 0; k < scenes.size(); ++k)
            scenes[k].share = static_cast<double>(k) / static_cast<double>(scenes.size());
        clock_ += kPause;
    }
    /// Distances in mixed order, `reads` rows at each.
    void distances(std::size_t sensor, int reads) {
        auto gaps = kGaps;
        for (std::size_t k = gaps.size(); k > 1; --k)
            std::swap(gaps[k - 1], gaps[random_.below(k)]);
        for (const double gap : gaps) {
            const double exact = gap * 1e-3 * (0.95 + 0.1 * random_.uniform());
            for (int k = 0; k < reads; ++k)
                read(sensor, exact, 0.0, 0.0);
        }
    }
    void oblique(std::size_t sensor) {
        for (int k = -6; k <= 6; ++k)
            for (int again = 0; again < 2; ++again)
                read(sensor, 0.015, k * 10 * kDesignDegree, 0.0);
    }
    void approach(std::size_t sensor, double speed) {
        for (double gap = 0.08; gap > 0.002; gap -= speed * kRow)
            read(sensor, gap, 0.0, speed);
    }
    std::vector<PlannedScenes> take() { return std::move(runs_); }

  private:
    RandomStream& random_;
    std::vector<PlannedScenes> runs_;
    Scene now_{};
    double clock_ = 5.0;
};

}  // namespace

std::vector<PlannedScenes> planned_scenes(RandomStream& random, bool one_object) {
    ProximityPlan plan(random);
    for (int repeat = 0; repeat < kRepeats; ++repeat) {
        plan.begin("white", "dark", "off", 0);
        if (one_object) {
            for (int k = 0; k < 4; ++k)
                plan.distances(2, 3);
            plan.end();
            continue;
        }
        for (std::size_t sensor = 0; sensor < kRing; ++sensor)
            plan.distances(sensor, 2);
        plan.end();
        plan.begin("white", "lamp", "off", 0);
        for (const std::size_t sensor : kSome)
            plan.distances(sensor, 2);
        plan.end();
        plan.begin("grey", "dark", "off", 0);
        for (const std::size_t sensor : kSome)
            plan.distances(sensor, 2);
        plan.end();
        plan.begin("white", "dark", "on", 800);
        for (const std::size_t sensor : kSome)
            plan.distances(sensor, 2);
        plan.end();
        plan.begin("white", "dark", "off", 0);
        for (std::size_t sensor = 0; sensor < kRing; ++sensor)
            plan.oblique(sensor);
        plan.end();
        plan.begin("white", "dark", "off", 0);
        for (const std::size_t sensor : {std::size_t{0}, std::size_t{7}})
            for (const double speed : {0.03, 0.06, 0.12})
                plan.approach(sensor, speed);
        plan.end();
    }
    return plan.take();
}

}  // namespace puckloop::gap::selftest
