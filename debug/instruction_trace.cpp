#include "debug/instruction_trace.h"

#include "base/error.h"
#include "base/files/new_file.h"
#include "base/files/partial_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

namespace puckloop::debug {

InstructionTrace::InstructionTrace(const std::string& file, const DebugChip& chip, const Places& places,
                                   const TraceFilter& filter, SecondsOf seconds_of)
    : file_(file),
      out_(new_file(file)),
      chip_(chip),
      places_(places),
      filter_(filter),
      seconds_of_(std::move(seconds_of)),
      before_(chip.registers().size()),
      after_(chip.registers().size()) {
    if (!out_)
        throw InputError(file, "", "cannot be written: " + why_not_written(errno),
                         "a place in a folder that exists and may be written");
    put("cycle\tpc\tplace\tline\tinstruction\tchanges\n");
}

InstructionTrace::~InstructionTrace() {
    if (out_) std::fclose(out_);
}

void InstructionTrace::put(const std::string& text) {
    if (out_) std::fwrite(text.data(), 1, text.size(), out_);
}

bool InstructionTrace::wanted(std::uint32_t pc, std::uint64_t cycle) const {
    const auto holds = [pc](const AddressRange& range) { return pc >= range.first && pc <= range.last; };
    if (!filter_.ranges.empty() && std::none_of(filter_.ranges.begin(), filter_.ranges.end(), holds))
        return false;
    const double now = seconds_of_(cycle);
    return now >= filter_.from_s && now < filter_.to_s;
}

bool InstructionTrace::instruction(std::uint32_t pc, std::uint64_t cycle) {
    complete();
    if (!wanted(pc, cycle)) return true;
    auto [text, fresh] = texts_.try_emplace(pc);
    // Programs rarely write themselves, but they may.
    const std::string instruction = chip_.instruction(pc).text;
    if (fresh || !text->second.ends_with("\t" + instruction))
        text->second =
            fmt::format("0x{:06x}\t{}\t{}\t{}", pc, places_.place(pc), places_.lines().at(pc), instruction);
    line_ = fmt::format("{}\t{}\t", cycle, text->second);
    chip_.read_registers(before_);
    writes_.clear();
    open_ = true;
    return true;
}

void InstructionTrace::access(std::uint16_t address, int bytes, bool write) {
    if (open_ && write) writes_.push_back({address, bytes});
}

void InstructionTrace::complete() {
    if (!std::exchange(open_, false)) return;
    chip_.read_registers(after_);
    std::string changes;
    const auto registers = chip_.registers();
    for (std::size_t i = 0; i < registers.size(); ++i)
        if (before_[i] != after_[i] && registers[i].type != "code_ptr")
            changes += fmt::format(" {}=0x{:0{}x}", registers[i].name,
                                   after_[i] & (~std::uint64_t{0} >> (64 - registers[i].bits)),
                                   registers[i].bits / 4);
    for (const Write& write : writes_) {
        std::uint8_t bytes[2]{};
        const std::span<std::uint8_t> read(bytes, static_cast<std::size_t>(write.bytes));
        if (!chip_.read_memory(chip_.address_of_data(write.address), read)) continue;
        const unsigned value = write.bytes == 2 ? bytes[0] | bytes[1] << 8 : bytes[0];
        changes += fmt::format(" [0x{:04x}]=0x{:0{}x}", write.address, value, 2 * write.bytes);
    }
    put(line_ + (changes.empty() ? changes : changes.substr(1)) + "\n");
}

void InstructionTrace::interrupt(int vector, std::uint32_t pc, std::uint64_t cycle) {
    complete();
    if (wanted(pc, cycle))
        put(fmt::format("{}\t0x{:06x}\t{}\t\tinterrupt {}\t\n", cycle, pc, places_.place(pc),
                        chip_.vector_name(vector)));
}

void InstructionTrace::reset(std::uint64_t cycle) {
    complete();
    if (filter_.ranges.empty() && wanted(0, cycle)) put(fmt::format("{}\t\t\t\treset\t\n", cycle));
}

void InstructionTrace::finish() {
    complete();
    if (!out_) return;
    const bool bad = std::ferror(out_) != 0;
    if (std::fclose(std::exchange(out_, nullptr)) == 0 && !bad) return;
    remove_partial(file_);
    throw RunError(file_ + ": cannot be written to the end");
}

}  // namespace puckloop::debug
