#include "emu/dspic/waits/loop_conditions.h"

#include "emu/dspic/machine/machine.h"
#include "emu/dspic/walk/symbolic_loop.h"

#include <algorithm>

namespace puckloop::dspic {

namespace {

constexpr int kMostSteps = 20'000;        ///< delays between two looks are walked through as well
constexpr int kLargestFrame = 256;        ///< bytes; beyond it W14 is no frame pointer
constexpr std::uint16_t kFewValues = 32;  ///< a compared word is tried with these
constexpr std::uint64_t kForever = std::numeric_limits<std::int64_t>::max();

class Finder {
  public:
    Finder(const Machine& m, const Op* branch, const Op* head) : m_(m), branch_(branch), head_(head) {}

    std::optional<LoopFinding> find() {
        LoopTrace trace;
        SymbolicLoop walk(m_, plan_, trace, {.on = true, .most_steps = kMostSteps});
        if (walk.analyse(branch_, head_) != SymbolicLoop::Verdict::Pure) return std::nullopt;
        LoopFinding finding;
        finding.first = m_.pc_of(head_);
        finding.last = m_.pc_of(branch_);
        finding.ends = plan_.iterations < kForever;
        for (const LoopTrace::Boundary& boundary : trace.boundaries)
            path_.push_back(boundary.op);
        if (!walk.chose()) return finding;
        const LoopPlan plan = plan_;  // the walks to come overwrite it
        for (std::size_t i = 0; i < plan.polled_count; ++i)
            try_word(plan.polled[i].address, plan.polled[i].value, finding);
        for (std::size_t i = 0; i < plan.count; ++i) {
            const LoopPlan::Cell& cell = plan.cells[i];
            if (cell.key < kRamStart || !cell.carried || cell.step != 0 || is_local(cell.key)) continue;
            try_word(cell.key, static_cast<std::uint16_t>(cell.start), finding);
        }
        return finding;
    }

  private:
    /// A variable in the frame of the function that waits: nobody else changes it.
    bool is_local(std::uint16_t address) const {
        const std::uint16_t frame = m_.st.w[14], stack = m_.st.w[15];
        return frame < stack && stack - frame <= kLargestFrame && address >= frame && address < stack;
    }

    /// True if the loop goes another way with these bits of the word inverted.
    bool matters(std::uint16_t address, std::uint16_t flip) {
        LoopTrace trace;
        SymbolicLoop walk(m_, plan_, trace,
                          {.on = true, .most_steps = kMostSteps, .address = address, .flip = flip});
        if (!walk.comes_round(branch_, head_)) return true;
        return !std::equal(path_.begin(), path_.end(), trace.boundaries.begin(), trace.boundaries.end(),
                           [](const Op* a, const LoopTrace::Boundary& b) { return a == b.op; });
    }

    void try_word(std::uint16_t address, std::uint16_t value, LoopFinding& finding) {
        LoopCondition condition{address, 0};
        for (unsigned bit = 0; bit < 16; ++bit) {
            const auto flip = static_cast<std::uint16_t>(1u << bit);
            if (matters(address, flip)) condition.mask |= flip;
        }
        // A word that is compared may want more than one bit changed.
        for (std::uint16_t other = 0; other <= kFewValues && condition.mask == 0; ++other) {
            const auto wanted = other == kFewValues ? std::uint16_t{0xFFFF} : other;
            if (matters(address, wanted ^ value)) {
                condition.mask = 0xFFFF;
                condition.exact = false;
            }
        }
        if (condition.mask != 0) finding.conditions.push_back(condition);
    }

    const Machine& m_;
    const Op* branch_;
    const Op* head_;
    LoopPlan plan_;
    std::vector<const Op*> path_;
};

}  // namespace

std::optional<LoopFinding> find_conditions(const Machine& m, const Op* branch, const Op* head) {
    return Finder(m, branch, head).find();
}

}  // namespace puckloop::dspic
