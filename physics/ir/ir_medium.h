#pragma once
// All range-and-bearing boards of a world and the light between them: who emits what, what arrives where.
// Knows poses and settings, not time; the node (ir_node.h) gives it an order.
//
// Coupling is computed when a burst begins, and again only when something has moved since. Strengths vary
// from burst to burst by log-normal factors, drawn when the burst begins from one stream a pair of boards.
//
// Deviations: 1. within a burst boards stand still (a robot moves at most 0.6 mm during a frame; longer
// bursts are refreshed, ir.refresh). 2. Noise does not vary within a burst.

#include "base/random.h"
#include "physics/ir/burst_outcomes.h"
#include "physics/ir/ir_coupling.h"
#include "physics/ir/ir_fault_effects.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::physics {

/// At the twelve receivers of one board.
struct IrLight {
    IrArray<float> carrier{}, level{};
};

inline constexpr std::size_t kNoBoard = static_cast<std::size_t>(-1);

/// Byte of a board that has not said anything about its power.
inline constexpr double kPotentiometerAtPowerOn = 128;

class IrMedium {
  public:
    /// Boards are the robots with `rab`, in the description's order, then the virtual ones. The description
    /// must have passed check(). `changes`: events may alter what is in the world, so that even a lone board
    /// may come to hear itself.
    explicit IrMedium(const World& world, bool changes = false);
    IrMedium(const IrMedium&) = delete;
    IrMedium& operator=(const IrMedium&) = delete;

    std::size_t board_count() const { return boards_.size(); }
    /// The first so many listen: boards of robots. Those behind them are virtual.
    std::size_t listener_count() const { return listeners_; }
    const std::string& name(std::size_t board) const { return boards_[board].name; }
    const IrParameters& parameters(std::size_t board) const { return boards_[board].model.parameters(); }
    /// False: nothing that any board does can reach this one.
    bool can_hear(std::size_t board) const;

    /// Pose of a robot or movable thing; `index` as in moving_names().
    void move(std::size_t index, double x, double y, double heading);
    /// A robot or movable thing is lifted or taken away, or is back: nothing passes between a board that is
    /// out and any other, and what is out shades nothing.
    void set_out(std::size_t index, bool out);
    /// One of the world's fixed things, or one that was added while it ran; height 0: it is gone.
    void set_shape(bool fixed, std::size_t index, const Shape& shape);
    /// Takes effect with the next begin_burst() or relight().
    void set_power(std::size_t board, double potentiometer);
    void set_carrier(std::size_t board, double hertz);
    void set_emitters(std::size_t board, std::uint16_t mask) { boards_[board].mask = mask; }
    std::uint16_t emitters(std::size_t board) const { return boards_[board].mask; }

    /// A burst of this board begins at `seconds`: new noise, coupling as things stand now.
    void begin_burst(std::size_t board, double seconds);
    /// Emitters, power or carrier changed within the burst. True: what it reaches may have changed.
    bool relight(std::size_t board);
    /// What it reaches is to be computed again: what faults do to it has changed.
    void relight_anew(std::size_t board);
    /// Couples the board anew if anything moved since; true if so.
    bool refresh(std::size_t board);

    /// Does light of `sender` arrive at `receiver`, at the present coupling?
    bool coupled(std::size_t sender, std::size_t receiver) const {
        return path(sender, receiver).coupling.any;
    }
    /// What `sender` by itself brings to `receiver` with the emitters that it had on last.
    const IrLight& from(std::size_t sender, std::size_t receiver) const {
        return path(sender, receiver).light;
    }
    /// All that arrives, baseline and ambient light included.
    IrLight at(std::size_t receiver) const;
    /// Between the robots' bodies, m.
    double distance(std::size_t a, std::size_t b) const;
    /// Of board `to` from the front of `from`, counter-clockwise, rad.
    double bearing(std::size_t from, std::size_t to) const;

    /// Faults; `effects` stays. Nullptr: none.
    void set_fault_effects(const IrFaultEffects* effects) { fault_effects_ = effects; }
    /// The carrier of `sender` at `receiver` if there were no faults.
    IrArray<float> without_faults(std::size_t sender, std::size_t receiver) const;

    /// What boards are set to, for a checkpoint. Paths, places and shapes, which are many and of which few
    /// change in a short time, stay out of it: from mark() on they are noted before they change, rewind(),
    /// called before the checkpoint is read, takes them back; the mark stays until settle().
    template <class Archive>
    void state(Archive& archive) {
        for (Board& board : boards_)
            archive(board.mask, board.lit_mask, board.potentiometer, board.carrier_hz, board.coupled_at,
                    board.out);
        archive(changes_);
    }
    void mark();
    void rewind();
    void settle() { undo_.on = false; }

  private:
    struct Board {
        std::string name;
        IrBoard model;
        std::size_t robot;  ///< index of its body
        std::uint16_t mask = 0;
        std::uint16_t lit_mask = 0;  ///< for which its paths' light holds; 0: for none
        double potentiometer = kPotentiometerAtPowerOn;
        double carrier_hz = 0.0;
        std::uint64_t coupled_at = 0;  ///< `changes_` when its row was computed
        bool out = false;              ///< its robot is held in the air
    };
    struct Path {
        IrCoupling coupling;
        IrLight factor, light;
        RandomStream noise;
        BurstOutcomes outcomes;
        std::size_t turn = 0;  ///< of the present burst
    };
    /// As it was at the mark (ir_medium_undo.cpp).
    struct Undo {
        enum : std::uint8_t { kLight = 1, kRow = 2 };
        struct Light {
            std::size_t sender = 0;
            std::vector<IrLight> light;
        };
        struct Row {
            std::size_t sender = 0;
            std::vector<Path> paths;
            std::vector<IrSpell> spells;
        };
        struct Body {
            std::size_t index = 0;
            Shape shape;
            std::optional<IrBoard> model;
        };
        struct Shapes {
            std::vector<Shape> fixed, added;
        };
        bool on = false;
        std::vector<std::uint8_t> rows_noted;  ///< of each sender: kLight, kRow
        std::vector<bool> bodies_noted;
        std::vector<Light> lights;  ///< the first light_count are in use; the others' room is kept
        std::vector<Row> rows;
        std::vector<Body> bodies;
        std::size_t light_count = 0, row_count = 0;
        std::optional<Shapes> shapes;
        bool mirrors = false;  ///< were found anew
    };
    void note_light(std::size_t sender);
    void note_row(std::size_t sender);
    void note_body(std::size_t index);
    void note_shapes();

    Path& path(std::size_t s, std::size_t r) { return paths_[s * boards_.size() + r]; }
    const Path& path(std::size_t s, std::size_t r) const { return paths_[s * boards_.size() + r]; }
    /// The same both ways.
    IrSpell& spell(std::size_t a, std::size_t b) {
        return spells_[std::min(a, b) * boards_.size() + std::max(a, b)];
    }
    void couple_row(std::size_t sender);
    void draw_noise(std::size_t sender, double seconds);
    /// By the present coupling, from the emitters in `mask`.
    template <bool kFaulty>
    void light(Path& to, std::uint16_t mask, const IrFaultEffects::Factors* effects = nullptr) const;
    /// What stands around and is high enough to shade the two boards.
    std::vector<const Shape*> between(const Board& a, const Board& b) const;

    std::vector<Board> boards_;
    std::vector<Path> paths_;  // [sender][receiver]
    std::vector<IrSpell> spells_;
    std::vector<IrArray<float>> dark_level_;
    void find_mirrors();
    void add_virtual(const World& world, const VirtualBoard& described);

    std::vector<Shape> fixed_, moving_, added_;
    std::vector<double> heights_;  // of what moves, when it is not out
    bool changes_world_;
    std::vector<const Shape*> mirrors_;
    std::vector<std::size_t> board_of_;  // of each moving body; kNoBoard for none
    std::size_t listeners_ = 0;
    std::uint64_t changes_ = 1;
    Undo undo_;
    const IrFaultEffects* fault_effects_ = nullptr;
};

}  // namespace puckloop::physics
