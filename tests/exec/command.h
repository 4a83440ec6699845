#pragma once
// The built `puckloop exec` as a user runs it, in a folder of its own.

#include "emu/dspic/assembler/assembler.h"
#include "emu/dspic/devices/device.h"
#include "tests/kit/files.h"

#include <string>
#include <string_view>

namespace puckloop::exec {

struct Outcome {
    int status = -1;
    std::string out;
    std::string err;
};

using tests::text_of;
/// Exactly one line, and not an empty one.
bool one_line(const std::string& text);

/// Of a source that may name the chip's registers.
dspic::Program assembled(std::string_view source, const dspic::DeviceInfo& device = dspic::dspic30f6014a());

class Workbench {
  public:
    Workbench();
    ~Workbench();
    Workbench(const Workbench&) = delete;
    Workbench& operator=(const Workbench&) = delete;

    /// Writes a file of the folder; returns its path.
    std::string file(const std::string& name, const std::string& content) const;
    /// The same with a program, as a HEX image.
    std::string image(const std::string& name, const dspic::Program& program) const;
    /// `puckloop exec ARGUMENTS`; `input` goes to standard input.
    Outcome run(const std::string& arguments, const std::string& input = {}) const;

    const std::string folder;
};

}  // namespace puckloop::exec
