#pragma once
// A chip's special-function registers: plain storage with masks, hooks where a register acts, and a report of
// the first touch of every register that no model stands behind. `Word` is the width of one register; an
// address counts bytes.

#include "emu/chip/event_queue.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string_view>
#include <utility>

namespace puckloop::chip {

/// One register of a device's table: the data sheet's name, its address, reset value and implemented bits.
template <class Word>
struct RegisterInfo {
    std::string_view name;
    std::uint16_t address = 0;
    Word reset = 0;           ///< power-on value; bits the sheet calls unknown are 0 here
    Word implemented = 0;     ///< bits that exist; the others read 0
    std::string_view fields;  ///< "WGM:1:0 COM0A:7:6 ..."; empty for registers that hold one number
};

template <class Word, std::size_t kBytes>
class RegisterSpace {
  public:
    using Info = RegisterInfo<Word>;
    using ReadHook = Word (*)(void* owner, std::uint16_t address);
    /// `mask`: the bits that the access writes; the others of `value` mean nothing.
    using WriteHook = void (*)(void* owner, std::uint16_t address, Word value, Word mask);
    enum class Behaviour : std::uint8_t { Absent, Unmodelled, Modelled };
    static constexpr std::size_t kWords = kBytes / sizeof(Word);

    /// Lists the device's registers. All are Unmodelled until a model claims them.
    void describe(std::span<const Info> registers) {
        for (const Info& info : registers) {
            Cell& cell = at(info.address);
            cell.info = &info;
            cell.behaviour = Behaviour::Unmodelled;
        }
        reset_values();
    }
    /// The register is right as plain storage (masked to its implemented bits).
    void claim(std::uint16_t address) { at(address).behaviour = Behaviour::Modelled; }
    /// Claims the register and routes its accesses; a null hook is plain storage on that side.
    void hook(std::uint16_t address, void* owner, ReadHook read, WriteHook write) {
        Cell& cell = at(address);
        cell.owner = owner;
        cell.read = read;
        cell.write = write;
        cell.behaviour = Behaviour::Modelled;
    }

    /// What a read would give, without its side effects, for whoever looks on; programs do not come here.
    void hook_quiet(std::uint16_t address, ReadHook quiet) { at(address).quiet = quiet; }
    /// By that hook, or the read hook where that has no side effects; else what is stored.
    Word quiet_read(std::uint16_t address) {
        const Cell& cell = at(address);
        if (cell.quiet) return cell.quiet(cell.owner, address);
        return cell.read && cell.steady ? cell.read(cell.owner, address) : raw(address);
    }

    /// Called at the first touch of each Unmodelled or Absent register: name (or empty), address, true for a
    /// write.
    std::function<void(std::string_view name, std::uint16_t address, bool write)> on_first_touch;

    Word read(std::uint16_t address) {
        const Cell& cell = at(address);
        if (cell.read) return cell.read(cell.owner, address);
        if (cell.behaviour != Behaviour::Modelled) touch(address, false);
        return raw(address);
    }
    void write(std::uint16_t address, Word value, Word mask) {
        const Cell& cell = at(address);
        if (cell.write) return cell.write(cell.owner, address, value, mask);
        if (cell.behaviour != Behaviour::Modelled) touch(address, true);
        store(address, value, mask);
    }

    /// A modelled register was asked for something that no model is behind: reported as a first touch, under
    /// `name`.
    void report_unmodelled(std::uint16_t address, std::string_view name, bool write) {
        bool& reported = reported_[address / sizeof(Word)];
        if (std::exchange(reported, true)) return;
        if (on_first_touch) on_first_touch(name, address, write);
    }

    /// The stored value itself, no side effects: what models keep their register contents in.
    Word& raw(std::uint16_t address) { return values_[address / sizeof(Word)]; }
    Word raw(std::uint16_t address) const { return values_[address / sizeof(Word)]; }
    /// Plain masked storage, for write hooks that only add to it.
    void store(std::uint16_t address, Word value, Word mask) {
        const Info* info = at(address).info;
        const Word bits = static_cast<Word>(info ? mask & info->implemented : 0);
        Word& slot = raw(address);
        slot = static_cast<Word>((slot & ~bits) | (value & bits));
    }
    /// The read hook has no side effect, and its value only changes with an event or an access.
    void mark_steady(std::uint16_t address) { at(address).steady = true; }
    /// A register without side effects whose value follows the clock: fills `values` with what reads at
    /// first, first + period, ... would give if nothing but time happened, and returns how many are known.
    using FollowHook = std::size_t (*)(void* owner, std::uint16_t address, Cycle first, Cycle period,
                                       std::span<Word> values);
    void set_follow(std::uint16_t address, FollowHook follow) { at(address).follow = follow; }
    std::size_t follow(std::uint16_t address, Cycle first, Cycle period, std::span<Word> values) const {
        const Cell& cell = at(address);
        return cell.follow ? cell.follow(cell.owner, address, first, period, values) : 0;
    }
    /// A loop that polls the register may be skipped until the next event.
    bool steady_read(std::uint16_t address) const {
        const Cell& cell = at(address);
        return cell.behaviour == Behaviour::Modelled && (cell.read == nullptr || cell.steady);
    }

    /// All registers to their power-on values, without hooks (the models reset themselves).
    void reset_values() {
        for (std::size_t i = 0; i < kWords; ++i)
            values_[i] = cells_[i].info ? cells_[i].info->reset : Word{0};
    }
    template <class Archive>
    void state(Archive& archive) {
        archive(values_, reported_);
    }

    const Info* info(std::uint16_t address) const { return at(address).info; }
    /// By data-sheet name; null if the device has no such register.
    const Info* find(std::string_view name) const {
        const auto found = std::find_if(cells_.begin(), cells_.end(), [&](const Cell& cell) {
            return cell.info && cell.info->name == name;
        });
        return found == cells_.end() ? nullptr : found->info;
    }

  private:
    struct Cell {
        ReadHook read = nullptr;
        WriteHook write = nullptr;
        FollowHook follow = nullptr;
        ReadHook quiet = nullptr;
        void* owner = nullptr;
        const Info* info = nullptr;
        Behaviour behaviour = Behaviour::Absent;
        bool steady = false;
    };
    Cell& at(std::uint16_t address) { return cells_[address / sizeof(Word)]; }
    const Cell& at(std::uint16_t address) const { return cells_[address / sizeof(Word)]; }
    void touch(std::uint16_t address, bool write) {
        const Cell& cell = at(address);
        bool& reported = reported_[address / sizeof(Word)];
        if (reported) return;
        reported = true;
        if (on_first_touch) on_first_touch(cell.info ? cell.info->name : std::string_view{}, address, write);
    }

    std::array<Word, kWords> values_{};
    std::array<Cell, kWords> cells_{};
    std::array<bool, kWords> reported_{};
};

}  // namespace puckloop::chip
