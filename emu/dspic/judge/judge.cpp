#include "emu/dspic/judge/judge.h"

#include "emu/dspic/devices/register_bits.h"
#include "emu/dspic/judge/routines.h"
#include "emu/dspic/machine/memory_map.h"
#include "emu/dspic/waits/status_bits.h"

#include <fmt/format.h>

namespace puckloop::dspic {

namespace {

constexpr RegisterBits kDMAxCON{"DMA?CON"};

constexpr int kHighestUser = 7;
constexpr std::uint16_t kDmaStep = 12;
constexpr int kDmaChannels = 8;

class Judge {
  public:
    Judge(const WaitContext& chip, int level) : chip_(chip), level_(level) {
        for (const IrqName& source : chip.device.irqs)
            if (comes(source.irq)) coming_.push_back(source.irq);
    }

    bool nobody_comes() const { return coming_.empty(); }

    /// Why the condition cannot change; nothing if it can.
    std::optional<std::string> stuck(const LoopCondition& condition) const {
        return condition.address < kRamStart ? register_stuck(condition) : ram_stuck(condition.address);
    }

    std::string text(const LoopCondition& condition) const {
        const RegisterInfo* info =
            condition.address < kRamStart ? chip_.sfr.info(condition.address) : nullptr;
        if (info == nullptr) return fmt::format("RAM 0x{:04x}", condition.address);
        return register_text(*info, condition.exact ? condition.mask : std::uint16_t{0xFFFF});
    }

  private:
    bool enabled(int irq) const {
        return level_ <= kHighestUser && chip_.interrupts.enabled(irq) &&
               chip_.interrupts.priority(irq) > level_;
    }
    bool comes(int irq) const { return enabled(irq) && !why_silent(chip_, irq); }

    bool routine_writes(int irq, std::uint16_t address) const {
        const std::uint32_t table = chip_.interrupts.alternate_table() ? chip_.device.aivt : chip_.device.ivt;
        const auto vector = static_cast<std::uint32_t>(irq + kTrapVectors);
        const std::uint32_t entry = chip_.core.program(table + 2 * vector);
        if (entry == 0 || entry >= chip_.device.flash_end) return false;
        return routine_names([&](std::uint32_t at) { return chip_.core.program(at); }, entry, address);
    }
    bool anybody_coming_writes(std::uint16_t address) const {
        for (const int irq : coming_)
            if (routine_writes(irq, address)) return true;
        return false;
    }

    std::optional<std::string> register_stuck(const LoopCondition& condition) const {
        const RegisterInfo* info = chip_.sfr.info(condition.address);
        if (info == nullptr) return "where the chip has no register";
        if (anybody_coming_writes(condition.address)) return std::nullopt;
        if (!chip_.sfr.modelled(condition.address)) return "which no model drives";
        const std::uint16_t driven = driven_bits(chip_.device, *info) & condition.mask;
        if (info->name.size() == 5 && info->name.starts_with("PORT")) return pins_stuck(*info, driven);
        const int word = (condition.address - chip_.device.ifs) / 2;
        if (driven != 0 && word >= 0 && word < chip_.device.ifs_words) return flags_stuck(word, driven);
        if (driven != 0) return std::nullopt;
        if (missing_bits(chip_.device, *info) & condition.mask) return "which no model drives";
        if (!coming_.empty()) return std::nullopt;
        return "which no interrupt can change";
    }

    std::optional<std::string> pins_stuck(const RegisterInfo& info, std::uint16_t mask) const {
        const auto port = static_cast<PortLetter>(info.name[4] - 'A');
        if (chip_.ports.changeable(port) & mask) return std::nullopt;
        std::string names;
        for (int bit = 0; bit < 16; ++bit) {
            const std::string_view function = chip_.pins.outside(port, bit).function;
            if (mask >> bit & 1 && !function.empty())
                names += fmt::format("{}{}", names.empty() ? "" : ", ", function);
        }
        return names.empty() ? "a pin on which nothing changes"
                             : fmt::format("a pin on which nothing changes ({})", names);
    }

    std::optional<std::string> flags_stuck(int word, std::uint16_t mask) const {
        std::string why;
        for (int bit = 0; bit < 16; ++bit) {
            if (!(mask >> bit & 1)) continue;
            const std::optional<std::string> silent = why_silent(chip_, 16 * word + bit);
            if (!silent) return std::nullopt;
            why += fmt::format("{}{}", why.empty() ? "" : ", ", *silent);
        }
        return "which stays as it is: " + why;
    }

    /// Who could let a silent source come, and does not come either.
    std::string starters(std::uint16_t gate, int irq) const {
        std::string text;
        for (const IrqName& source : chip_.device.irqs) {
            if (gate == 0 || source.irq == irq || !routine_writes(source.irq, gate)) continue;
            const std::optional<std::string> silent = why_silent(chip_, source.irq);
            if (silent)
                text += fmt::format(" (the routine of {} may change that, but {})", source.name, *silent);
        }
        return text;
    }

    bool dma_writes() const {
        if (chip_.layout.dma.con == 0) return false;
        for (int channel = 0; channel < kDmaChannels; ++channel)
            if (chip_.sfr.raw(static_cast<std::uint16_t>(chip_.layout.dma.con + kDmaStep * channel)) &
                kDMAxCON["CHEN"])
                return true;
        return false;
    }

    std::optional<std::string> ram_stuck(std::uint16_t address) const {
        if (dma_writes() || anybody_coming_writes(address)) return std::nullopt;
        std::string why;
        for (const IrqName& source : chip_.device.irqs) {
            if (!routine_writes(source.irq, address)) continue;
            const std::optional<std::string> silent = why_silent(chip_, source.irq);
            const auto enable = static_cast<std::uint16_t>(chip_.device.iec + 2 * (source.irq / 16));
            const std::uint16_t gate = silent ? control_register(chip_, source.irq) : enable;
            if (gate != 0 && anybody_coming_writes(gate)) return std::nullopt;
            why += fmt::format("{}{} writes, and ", why.empty() ? "which only the routine of " : "; or of ",
                               source.name);
            why += silent ? *silent : fmt::format("{} is 0", source.enable);
            why += starters(gate, source.irq);
        }
        if (!why.empty()) return why;
        if (!coming_.empty()) return std::nullopt;
        return "which no interrupt can change";
    }

    const WaitContext& chip_;
    int level_;
    std::vector<int> coming_;
};

}  // namespace

WaitReport judge(const WaitContext& chip, const LoopFinding& finding, int level) {
    const Judge judge(chip, level);
    WaitReport report;
    report.first = finding.first;
    report.last = finding.last;
    std::string stuck, free;
    const auto add = [](std::string& list, const std::string& item) {
        list += (list.empty() ? "reading " : "; ") + item;
    };
    for (const LoopCondition& condition : finding.conditions) {
        const std::optional<std::string> why = judge.stuck(condition);
        add(why ? stuck : free, judge.text(condition) + (why ? ", " + *why : std::string()));
    }
    if (finding.conditions.empty()) {
        report.hung = !finding.ends && judge.nobody_comes();
        report.text = report.hung    ? "which has no end, and no interrupt can come"
                      : finding.ends ? "which counts, and ends by itself"
                                     : "which has no end";
    } else {
        report.hung = !finding.ends && free.empty();
        report.text = free.empty() ? stuck : free;
    }
    return report;
}

bool sleeps_for_ever(const WaitContext& chip) {
    for (const IrqName& source : chip.device.irqs)
        if (chip.interrupts.enabled(source.irq) && !why_silent(chip, source.irq)) return false;
    return true;
}

}  // namespace puckloop::dspic
