#include "physics/ir/ir_medium.h"

#include "physics/description/robot_parameters.h"

#include <algorithm>
#include <cmath>

namespace puckloop::physics {

namespace {
constexpr double kVirtualCarrier = 482'353;  // Hz: what the original firmware sets, docs/rab.md
}

IrMedium::IrMedium(const World& world, bool changes) : fixed_(fixed_shapes(world)), changes_world_(changes) {
    for (const Robot& robot : world.robots) {
        const Parameters parameters = parameters_of(world, robot);
        const auto& body = parameters.robot;
        moving_.push_back(circle_shape(robot.x, robot.y, body.radius, body.height, body.reflectivity));
        board_of_.push_back(boards_.size());
        if (!robot.rab) {
            board_of_.back() = kNoBoard;
            continue;
        }
        Board board{robot.name,
                    IrBoard(parameters.ir, world.seed, robot.name),
                    moving_.size() - 1,
                    0,
                    0,
                    kPotentiometerAtPowerOn,
                    0.0,
                    0};
        board.model.place(robot.x, robot.y, robot.heading);
        boards_.push_back(std::move(board));
        auto& dark = dark_level_.emplace_back();
        for (std::size_t k = 0; k < kIrSensors; ++k)
            dark[k] =
                static_cast<float>(parameters.ir.baseline[k] + parameters.ir.ambient * world.ambient_light);
    }
    const auto add_movable = [this, &world](const auto& things) {
        for (const auto& thing : things) {
            if (!thing.movable) continue;
            moving_.push_back(shape_of(thing));
            board_of_.push_back(kNoBoard);
        }
    };
    add_movable(world.boxes);
    add_movable(world.cylinders);
    listeners_ = boards_.size();
    for (const VirtualBoard& virtual_board : world.virtuals.boards)
        add_virtual(world, virtual_board);
    for (const Board& sender : boards_)
        for (const Board& receiver : boards_) {
            const std::string pair = sender.name + ">" + receiver.name;
            paths_.push_back({{},
                              {},
                              {},
                              RandomStream(world.seed, "ir/" + pair),
                              BurstOutcomes(receiver.model.parameters(), world.seed, pair)});
            spells_.emplace_back(sender.model.parameters(), world.seed, sender.name + "," + receiver.name);
        }
    for (const Shape& shape : moving_)
        heights_.push_back(shape.height);
    find_mirrors();
}

/// Like a robot's, but nothing stands there that could shade or reflect.
void IrMedium::add_virtual(const World& world, const VirtualBoard& described) {
    const Parameters parameters = with({}, world.parameters);
    moving_.push_back(circle_shape(described.x, described.y, parameters.robot.radius, 0.0, 0.0));
    board_of_.push_back(boards_.size());
    Board board{described.name,
                IrBoard(parameters.ir, world.seed, described.name),
                moving_.size() - 1,
                0,
                0,
                described.power,
                kVirtualCarrier,
                0};
    board.model.place(described.x, described.y, described.heading);
    boards_.push_back(std::move(board));
    dark_level_.emplace_back();
}

void IrMedium::find_mirrors() {
    mirrors_.clear();
    for (const auto* shapes : {&fixed_, &moving_, &added_})
        for (const Shape& shape : *shapes)
            if (shape.kind == Shape::Kind::Box && shape.height > 0.0) mirrors_.push_back(&shape);
}

void IrMedium::set_out(std::size_t index, bool out) {
    note_body(index);
    undo_.mirrors = true;
    moving_[index].height = out ? 0.0 : heights_[index];
    if (board_of_[index] < boards_.size()) boards_[board_of_[index]].out = out;
    find_mirrors();
    ++changes_;
}

void IrMedium::set_shape(bool fixed, std::size_t index, const Shape& shape) {
    note_shapes();
    auto& shapes = fixed ? fixed_ : added_;
    if (shapes.size() <= index) shapes.resize(index + 1);
    shapes[index] = shape;
    find_mirrors();
    ++changes_;
}

bool IrMedium::can_hear(std::size_t board) const {
    const auto& p = boards_[board].model.parameters();
    return boards_.size() > 1 || p.self_coupling > 0.0 ||
           (p.reflection > 0.0 && (changes_world_ || !mirrors_.empty()));
}

void IrMedium::move(std::size_t index, double x, double y, double heading) {
    note_body(index);
    moving_[index].place(x, y, heading);
    if (board_of_[index] < boards_.size()) boards_[board_of_[index]].model.place(x, y, heading);
    ++changes_;
}

void IrMedium::set_power(std::size_t board, double potentiometer) {
    boards_[board].potentiometer = potentiometer;
    boards_[board].coupled_at = 0;
}

void IrMedium::set_carrier(std::size_t board, double hertz) {
    boards_[board].carrier_hz = hertz;
    boards_[board].coupled_at = 0;
}

double IrMedium::distance(std::size_t a, std::size_t b) const {
    const IrBoard& first = boards_[a].model;
    const IrBoard& second = boards_[b].model;
    return std::hypot(first.x() - second.x(), first.y() - second.y()) - moving_[boards_[a].robot].radius -
           moving_[boards_[b].robot].radius;
}

double IrMedium::bearing(std::size_t from, std::size_t to) const {
    const IrBoard& a = boards_[from].model;
    const IrBoard& b = boards_[to].model;
    return std::atan2(b.y() - a.y(), b.x() - a.x()) - a.heading();
}

std::vector<const Shape*> IrMedium::between(const Board& a, const Board& b) const {
    const double height = std::min(a.model.parameters().height, b.model.parameters().height);
    const bool mirrors = b.model.parameters().reflection > 0.0;
    const double dx = b.model.x() - a.model.x();
    const double dy = b.model.y() - a.model.y();
    const double length = std::hypot(dx, dy);
    const double side = std::max(a.model.parameters().ring, b.model.parameters().ring);
    std::vector<const Shape*> shapes;
    const auto see = [&](const Shape& shape) {
        if (shape.height <= height) return;
        const double x = shape.x - a.model.x();
        const double y = shape.y - a.model.y();
        const double along = length > 0.0 ? std::clamp((x * dx + y * dy) / length, 0.0, length) : 0.0;
        const double near_x = length > 0.0 ? x - along * dx / length : x;
        const double near_y = length > 0.0 ? y - along * dy / length : y;
        if (mirrors || std::hypot(near_x, near_y) < side + shape.radius) shapes.push_back(&shape);
    };
    for (const Shape& shape : fixed_)
        see(shape);
    for (const Shape& shape : added_)
        see(shape);
    for (std::size_t i = 0; i < moving_.size(); ++i)
        if (i != a.robot && i != b.robot) see(moving_[i]);
    return shapes;
}

void IrMedium::couple_row(std::size_t sender) {
    Board& from = boards_[sender];
    const IrDrive drive{from.model.power(from.potentiometer), from.carrier_hz};
    for (std::size_t r = 0; r < boards_.size(); ++r) {
        if (from.out || boards_[r].out) {
            path(sender, r).coupling = {};
            continue;
        }
        const bool reflects = parameters(r).reflection > 0.0;
        const auto mirrors =
            reflects ? std::span<const Shape* const>(mirrors_) : std::span<const Shape* const>();
        path(sender, r).coupling =
            couple(from.model, boards_[r].model, drive, between(from, boards_[r]), mirrors);
    }
    from.coupled_at = changes_;
    from.lit_mask = 0;
}

void IrMedium::draw_noise(std::size_t sender, double seconds) {
    for (std::size_t r = 0; r < boards_.size(); ++r) {
        const IrParameters& p = parameters(r);
        Path& to = path(sender, r);
        const double near = p.near_noise * std::exp(-std::max(distance(sender, r), 0.0) / p.near_range);
        const double common = std::hypot(p.frame_noise, near) * to.noise.normal();
        for (std::size_t k = 0; k < kIrSensors; ++k) {
            to.factor.level[k] = static_cast<float>(std::exp(common + p.receiver_noise * to.noise.normal()));
            to.factor.carrier[k] = static_cast<float>(std::exp(p.carrier_noise * to.noise.normal()));
        }
        const BurstOutcome outcome = to.outcomes.next();
        to.turn = outcome.turn;
        if (spell(sender, r).at(seconds) || outcome.lost) to.factor.carrier = {};
        if (outcome.strength != 1.0F)
            for (float& level : to.factor.level)
                level *= outcome.strength;
    }
}

void IrMedium::begin_burst(std::size_t board, double seconds) {
    note_row(board);
    draw_noise(board, seconds);
    boards_[board].lit_mask = 0;
    if (boards_[board].coupled_at != changes_) boards_[board].coupled_at = 0;
    relight(board);
}

bool IrMedium::refresh(std::size_t board) {
    if (boards_[board].coupled_at == changes_) return false;
    boards_[board].coupled_at = 0;
    relight(board);
    return true;
}

template <bool kFaulty>
void IrMedium::light(Path& to, std::uint16_t mask, const IrFaultEffects::Factors* effects) const {
    to.light = {};
    if (!to.coupling.any) return;
    for (std::size_t e = 0; e < kIrSensors; ++e) {
        if ((mask >> e & 1U) == 0) continue;
        for (std::size_t k = 0; k < kIrSensors; ++k) {
            const float share = kFaulty ? effects->emitter[e] : 1.0F;
            to.light.carrier[k] += share * to.coupling.carrier[e][k];
            to.light.level[k] += share * to.coupling.level[e][k];
        }
    }
    const auto turn = static_cast<std::ptrdiff_t>(kIrSensors - to.turn) % kIrSensors;
    std::rotate(to.light.carrier.begin(), to.light.carrier.begin() + turn, to.light.carrier.end());
    std::rotate(to.light.level.begin(), to.light.level.begin() + turn, to.light.level.end());
    for (std::size_t k = 0; k < kIrSensors; ++k) {
        to.light.carrier[k] *= to.factor.carrier[k] * (kFaulty ? effects->carrier[k] : 1.0F);
        to.light.level[k] *= to.factor.level[k] * (kFaulty ? effects->level[k] : 1.0F);
    }
}

bool IrMedium::relight(std::size_t board) {
    Board& from = boards_[board];
    if (from.mask == 0 && fault_effects_ == nullptr) return false;  // nobody looks at its light
    const bool anew = from.mask != 0 && from.coupled_at == 0;
    if (anew) {
        note_row(board);
        couple_row(board);
    }
    if (from.mask == from.lit_mask) return false;
    note_light(board);
    from.lit_mask = from.mask;
    for (std::size_t r = 0; r < boards_.size(); ++r) {
        Path& to = path(board, r);
        if (fault_effects_ == nullptr) {
            light<false>(to, from.mask);
            continue;
        }
        const std::uint16_t mask = fault_effects_->lit(board, r, from.mask);
        IrFaultEffects::Factors factors;
        if (fault_effects_->weakens(board, r, factors))
            light<true>(to, mask, &factors);
        else
            light<false>(to, mask);
    }
    return anew;
}

void IrMedium::relight_anew(std::size_t board) {
    note_light(board);
    boards_[board].lit_mask = static_cast<std::uint16_t>(~boards_[board].mask);
    relight(board);
}

IrArray<float> IrMedium::without_faults(std::size_t sender, std::size_t receiver) const {
    Path copy = path(sender, receiver);
    light<false>(copy, boards_[sender].mask);
    return copy.light.carrier;
}

IrLight IrMedium::at(std::size_t receiver) const {
    IrLight sum;
    sum.level = dark_level_[receiver];
    for (std::size_t s = 0; s < boards_.size(); ++s) {
        if (boards_[s].mask == 0 && fault_effects_ == nullptr) continue;
        const Path& to = path(s, receiver);
        if (!to.coupling.any) continue;
        for (std::size_t k = 0; k < kIrSensors; ++k) {
            sum.carrier[k] += to.light.carrier[k];
            sum.level[k] += to.light.level[k];
        }
    }
    if (fault_effects_ != nullptr) fault_effects_->add_ambient(receiver, sum.level);
    return sum;
}

}  // namespace puckloop::physics
