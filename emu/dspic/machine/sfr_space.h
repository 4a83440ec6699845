#pragma once
// The special-function register space, 0x0000 to 0x07FF: plain storage with masks, hooks where a register
// acts, and a report of the first touch of every register that no model stands behind.

#include "emu/dspic/devices/register_info.h"
#include "emu/dspic/machine/event_queue.h"

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string_view>

namespace puckloop::dspic {

/// A register access as hooks see it. Addresses are even. `mask` is 0xFFFF, 0x00FF or 0xFF00: which bytes are
/// written.
using ReadHook = std::uint16_t (*)(void* owner, std::uint16_t address);
using WriteHook = void (*)(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);

class SfrSpace {
  public:
    static constexpr std::size_t kWords = 0x400;
    enum class Behaviour : std::uint8_t { Absent, Stored, Modelled, Unmodelled };

    /// Lists the device's registers. All are Unmodelled until a model claims them.
    void describe(std::span<const RegisterInfo> registers);
    /// The word is right as plain storage (masked to its implemented bits), and a model stands behind it.
    void claim(std::uint16_t address);
    /// Claims the word and routes its accesses; either hook may be null (plain storage on that side).
    void hook(std::uint16_t address, void* owner, ReadHook read, WriteHook write);

    /// What a read would return, without its side effects, of a word whose read hook has some. For whoever
    /// looks on; the program's reads do not come here.
    void hook_quiet(std::uint16_t address, void* owner, ReadHook read) {
        words_[address >> 1].quiet = read;
        words_[address >> 1].owner = owner;
    }
    /// True where quiet_read() knows the word's value.
    bool quiet(std::uint16_t address) const {
        const Word& word = words_[address >> 1];
        return !word.read || word.quiet;
    }
    std::uint16_t quiet_read(std::uint16_t address) const {
        const Word& word = words_[address >> 1];
        return word.quiet ? word.quiet(word.owner, address) : raw(address);
    }
    /// A model acts on the word or keeps it.
    bool modelled(std::uint16_t address) const {
        return words_[address >> 1].behaviour == Behaviour::Modelled;
    }

    /// A model acts on accesses to the word, or changes it.
    bool acts(std::uint16_t address) const {
        const Word& word = words_[address >> 1];
        return word.read || word.write;
    }

    /// Writing the word the value that it holds does nothing, although a hook stands behind it.
    void mark_idempotent(std::uint16_t address) { words_[address >> 1].idempotent = true; }
    bool idempotent(std::uint16_t address) const {
        const Word& word = words_[address >> 1];
        return word.idempotent || (!word.write && word.behaviour == Behaviour::Modelled);
    }

    /// Words by what a read is besides a look at the stored word, and until when it is nothing: what
    /// translated code goes by. A read at cycle c is a plain look if c < until[kind[word]].
    struct Plain {
        static constexpr std::uint8_t kNever = 0, kAlways = 1, kConverter = 2, kKinds = 3;
        std::array<std::uint16_t, kWords> value{};
        std::array<std::uint8_t, kWords> kind{};
        std::array<Cycle, kKinds> until{0, kNoCycle, 0};
    };
    Plain& plain() { return plain_; }
    /// Changes whenever a word's kind may have.
    std::uint32_t layout_changes() const { return layout_changes_; }
    /// A hooked word whose model states by Plain::until how long nothing happens at a read.
    void set_plain_kind(std::uint16_t address, std::uint8_t kind) {
        words_[address >> 1].plain_kind = kind;
        plain_.kind[address >> 1] = kind;
        ++layout_changes_;
    }

    /// Takes the word away from its model: it reads 0 and ignores writes. And gives it back.
    void set_off(std::uint16_t address, bool off);

    /// Called at the first touch of each Unmodelled or Absent word: name (or empty), address, true for a
    /// write.
    std::function<void(std::string_view name, std::uint16_t address, bool write)> on_first_touch;

    std::uint16_t read(std::uint16_t address) {
        const Word& word = words_[address >> 1];
        if (word.read) return word.read(word.owner, address);
        if (word.behaviour != Behaviour::Modelled && word.behaviour != Behaviour::Stored)
            touch(address, false);
        return raw(address);
    }
    void write(std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
        const Word& word = words_[address >> 1];
        if (word.write) return word.write(word.owner, address, value, mask);
        if (word.behaviour != Behaviour::Modelled && word.behaviour != Behaviour::Stored)
            touch(address, true);
        store(address, value, mask);
    }

    /// The stored word itself, no side effects: what models keep their register contents in.
    std::uint16_t& raw(std::uint16_t address) { return plain_.value[address >> 1]; }
    std::uint16_t raw(std::uint16_t address) const { return plain_.value[address >> 1]; }
    /// Plain masked storage, for write hooks that only add to it.
    void store(std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
        const std::uint16_t bits = static_cast<std::uint16_t>(mask & words_[address >> 1].implemented);
        std::uint16_t& slot = raw(address);
        slot = static_cast<std::uint16_t>((slot & ~bits) | (value & bits));
    }
    /// True where a plain read has no side effect and no hook: a loop that polls it can be skipped safely as
    /// long as no event falls due.
    bool plain_read(std::uint16_t address) const { return words_[address >> 1].read == nullptr; }

    /// All registers to their power-on values, without hooks (the models reset themselves).
    void reset_values();
    const RegisterInfo* info(std::uint16_t address) const { return words_[address >> 1].info; }
    /// By data-sheet name; null if the device has no such register.
    const RegisterInfo* find(std::string_view name) const;

    template <class Archive>
    void state(Archive& archive) {
        archive(plain_.value, reported_);
    }

  private:
    struct Word {
        ReadHook read = nullptr;
        WriteHook write = nullptr;
        ReadHook quiet = nullptr;
        void* owner = nullptr;
        const RegisterInfo* info = nullptr;
        std::uint16_t implemented = 0;
        Behaviour behaviour = Behaviour::Absent;
        bool idempotent = false;
        std::uint8_t plain_kind = Plain::kNever;
    };
    void find_kind(std::uint16_t address);
    void touch(std::uint16_t address, bool write);

    Plain plain_;
    std::uint32_t layout_changes_ = 0;
    std::array<Word, kWords> words_{};
    std::array<bool, kWords> reported_{};
    std::map<std::uint16_t, Word> off_;  ///< as they were, by address
};

}  // namespace puckloop::dspic
