#include "bench/debugger/motion.h"

namespace puckloop::exec::debugger {

using debug::Flow;
using debug::Stop;

void Motion::add_break(std::uint32_t pc) {
    breaks_.insert(pc);
    debugged_.control().add_break(pc);
}

void Motion::remove_break(std::uint32_t pc) {
    breaks_.erase(pc);
    debugged_.control().remove_break(pc);
}

Stop Motion::run_out(std::uint32_t pc, std::uint16_t sp) {
    debug::DebugChip& chip = debugged_.chip();
    while (true) {
        debugged_.control().add_break(pc);
        const Stop stop = debugged_.forward(false);
        if (!is_break(pc)) debugged_.control().remove_break(pc);
        if (stop.why != Stop::Why::Break || chip.pc() != pc) return stop;
        if (!deeper(chip, chip.stack_pointer(), sp)) return {Stop::Why::Step};
        if (is_break(pc)) return stop;  // deeper within a recursion
    }
}

Stop Motion::run_to(std::uint32_t pc) {
    debugged_.control().add_break(pc);
    const Stop stop = debugged_.forward(false);
    if (!is_break(pc)) debugged_.control().remove_break(pc);
    return stop;
}

Stop Motion::next_instruction() {
    debug::DebugChip& chip = debugged_.chip();
    const std::uint32_t pc = chip.pc();
    const std::uint16_t sp = chip.stack_pointer();
    const debug::Instruction instruction = chip.instruction(pc);
    const Stop stop = debugged_.forward(true);
    if (stop.why != Stop::Why::Step || !deeper(chip, chip.stack_pointer(), sp)) return stop;
    if (program_.is_interrupt_entry(chip.pc()) && instruction.flow != Flow::Call) {
        const Stop out = run_out(pc, sp);
        return out.why == Stop::Why::Step ? next_instruction() : out;
    }
    return instruction.flow == Flow::Call ? run_out(pc + instruction.size, sp) : stop;
}

Stop Motion::step_line(bool into) {
    debug::DebugChip& chip = debugged_.chip();
    const SourceLine line = program_.line_of(chip.pc());
    const std::uint32_t function = program_.function_of(chip.pc());
    if (line.line == 0) return into ? step_instruction() : next_instruction();
    while (true) {
        const std::uint32_t pc = chip.pc();
        const std::uint16_t sp = chip.stack_pointer();
        const debug::Instruction instruction = chip.instruction(pc);
        Stop stop = debugged_.forward(true);
        if (stop.why != Stop::Why::Step) return stop;
        const bool down = deeper(chip, chip.stack_pointer(), sp);
        if (down && instruction.flow != Flow::Call && program_.is_interrupt_entry(chip.pc())) {
            stop = run_out(pc, sp);
            if (stop.why != Stop::Why::Step) return stop;
            continue;
        }
        if (down && instruction.flow == Flow::Call && chip.pc() != pc + instruction.size) {
            if (into && has_lines(chip.pc())) return stop;
            stop = run_out(pc + instruction.size, sp);
            if (stop.why != Stop::Why::Step) return stop;
        }
        const bool returned = instruction.flow == Flow::Return || instruction.flow == Flow::InterruptReturn;
        const bool elsewhere = program_.function_of(chip.pc()) != function;
        if (!has_lines(chip.pc())) {
            if (returned || elsewhere) return stop;
            continue;
        }
        if (elsewhere || (program_.line_of(chip.pc()) != line && program_.starts_line(chip.pc())))
            return stop;
        // The loop came back to where the line begins: a line that repeats is stepped once.
        if (program_.line_of(chip.pc()) == line && chip.pc() < pc && program_.starts_line(chip.pc()) &&
            instruction.flow == Flow::Other && line == program_.line_of(pc))
            return stop;
    }
}

Stop Motion::finish(std::size_t frame) {
    const auto frames = backtrace(debugged_.chip(), program_, frame + 1);
    if (frame == 0 || frames.size() <= frame) return {Stop::Why::Begin};
    return run_out(frames[frame].pc, frames[frame].stack);
}

Stop Motion::back_line(bool into) {
    debug::DebugChip& chip = debugged_.chip();
    if (!has_lines(chip.pc())) return back_instruction();
    std::vector<std::uint32_t> places = into ? program_.all_line_starts() : program_.line_starts(chip.pc());
    if (!into) {
        const auto frames = backtrace(chip, program_, 2);
        if (frames.size() > 1)
            for (const std::uint32_t pc : program_.line_starts(frames[1].pc))
                places.push_back(pc);
    }
    for (const std::uint32_t pc : places)
        debugged_.control().add_break(pc);
    const Stop stop = debugged_.backward(false);
    for (const std::uint32_t pc : places)
        if (!is_break(pc)) debugged_.control().remove_break(pc);
    return stop.why == Stop::Why::Break && !is_break(chip.pc()) ? Stop{Stop::Why::Step} : stop;
}

}  // namespace puckloop::exec::debugger
