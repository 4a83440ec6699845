// What becomes of single bursts: shares, spells and reflections are those that were asked for.

#include "physics/ir/burst_outcomes.h"
#include "physics/ir/ir_medium.h"
#include "tests/physics/ir_worlds.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace puckloop;
using namespace puckloop::physics;
using namespace puckloop::physics::test;

namespace {

IrParameters with(double IrParameters::*place, double value) {
    IrParameters p = Parameters().ir;
    p.*place = value;
    return p;
}

}  // namespace

TEST_CASE("without a reason every burst arrives as it is") {
    BurstOutcomes outcomes(Parameters().ir, 1, "a>b");
    IrSpell spell(Parameters().ir, 1, "a,b");
    for (int k = 0; k < 100; ++k) {
        const BurstOutcome one = outcomes.next();
        CHECK(!one.lost);
        CHECK(!spell.at(0.02 * k));
        CHECK(one.turn == 0);
        CHECK(one.strength == 1.0F);
    }
}

TEST_CASE("spells: a share of all time, remembered for a time") {
    IrParameters p = with(&IrParameters::spell, 0.2);
    p.spell_time = 0.5;
    IrSpell spell(p, 1, "a,b");
    constexpr int kBursts = 200'000;
    constexpr double kApart = 0.1;  // s
    int lost = 0, both = 0;
    bool last = false;
    for (int k = 0; k < kBursts; ++k) {
        const bool now = spell.at(kApart * k);
        lost += now ? 1 : 0;
        both += now && last ? 1 : 0;
        last = now;
    }
    CHECK(lost == Approx(0.2 * kBursts).epsilon(0.03));
    CHECK(both == Approx(lost * (0.2 + 0.8 * std::exp(-kApart / 0.5))).epsilon(0.03));
}

TEST_CASE("reflections: a share of the bursts, weaker by the loss, from about 0.6 rad beside") {
    IrParameters p = with(&IrParameters::stray, 0.1);
    p.stray_loss = 0.7;
    BurstOutcomes outcomes(p, 2, "a>b");
    constexpr int kBursts = 50'000;
    double stray = 0, log_sum = 0, turned = 0;
    for (int k = 0; k < kBursts; ++k) {
        const BurstOutcome one = outcomes.next();
        if (one.strength == 1.0F) continue;
        ++stray;
        log_sum += std::log(one.strength);
        const double turn = one.turn > 6 ? static_cast<double>(one.turn) - 12 : static_cast<double>(one.turn);
        turned += turn * turn;
    }
    CHECK(stray == Approx(0.1 * kBursts).epsilon(0.05));
    CHECK(log_sum / stray == Approx(-0.7).margin(0.02));
    CHECK(std::sqrt(turned / stray) * 0.5236 == Approx(0.6).margin(0.04));
}

TEST_CASE("a reflection brings the light to other receivers") {
    World world = ideal_pair(0.3);
    world.parameters["ir.stray"] = 1.0;
    world.parameters["ir.stray_loss"] = 1.0;
    World straight = ideal_pair(0.3);
    IrMedium bent(world), plain(straight);
    const double whole = total(shine(plain).level);
    const std::size_t facing = strongest(plain.from(0, 1).level);
    int elsewhere = 0;
    double weaker = 0;
    for (int k = 0; k < 200; ++k) {
        const IrLight light = shine(bent);
        elsewhere += strongest(light.level) != facing ? 1 : 0;
        weaker += std::log(total(light.level) / whole) / 200;
        CHECK(total(light.carrier) == Approx(total(plain.from(0, 1).carrier)));
    }
    CHECK(elsewhere > 100);  // two in three, by the scatter of 0.6 rad
    CHECK(weaker == Approx(-1.0).margin(0.07));
}
