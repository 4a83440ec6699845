#include "tests/exec/command.h"

#include "emu/image/intel_hex.h"
#include "tests/kit/files.h"

#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace puckloop::exec {

bool one_line(const std::string& text) {
    return !text.empty() && text.find('\n') == text.size() - 1;
}

dspic::Program assembled(std::string_view source, const dspic::DeviceInfo& device) {
    dspic::AssembleOptions options;
    for (const dspic::RegisterInfo& info : device.registers)
        options.predefined[std::string(info.name)] = info.address;
    return dspic::assemble(source, options);
}

Workbench::Workbench()
    : folder(std::filesystem::temp_directory_path() / ("puckloop_cli_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder);
}

Workbench::~Workbench() {
    std::filesystem::remove_all(folder);
}

std::string Workbench::file(const std::string& name, const std::string& content) const {
    std::ofstream(folder + "/" + name, std::ios::binary) << content;
    return folder + "/" + name;
}

std::string Workbench::image(const std::string& name, const dspic::Program& program) const {
    return file(name, image::write_dspic_hex(program.words));
}

Outcome Workbench::run(const std::string& arguments, const std::string& input) const {
    const std::string in = file("stdin", input), out = folder + "/stdout", err = folder + "/stderr";
    const std::string command =
        std::string(PUCKLOOP_PROGRAM) + " exec " + arguments + " <" + in + " >" + out + " 2>" + err;
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text_of(out), text_of(err)};
}

}  // namespace puckloop::exec
