// `puckloop upload`: a program into the flash of an e-puck's main board by its resident boot loader.

#include "base/error.h"
#include "base/files/new_file.h"
#include "base/files/text_file.h"
#include "bench/upload/serial_upload.h"
#include "tools/chips/chips.h"
#include "tools/cli/check.h"
#include "tools/cli/command.h"
#include "tools/cli/other_programs.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <memory>

namespace puckloop::tools {

namespace {

struct UploadOptions {
    std::string image, port, script;
    double at = 1.0, wait = 30.0, baud = 115200;
};

/// Rows are sent at times of their own, late enough for the flash: nobody reads the answers.
void write_script(const std::vector<BootPacket>& packets, const std::string& file, double at, double baud) {
    constexpr double kHello = 0.1, kFlash = 0.0162;  // s; erasing and writing take 4 ms
    constexpr double kBitsOfRow = 10 * 101;
    const double row = kFlash + kBitsOfRow / baud;  // 25 ms at 115200
    std::string lines = fmt::format("{:.3f} {:02x}\n", at, kBootHello);
    double time = at + kHello;
    const auto add = [&](const BootPacket& packet) {
        lines += fmt::format("{:.3f}", time);
        for (const std::uint8_t octet : packet)
            lines += fmt::format(" {:02x}", octet);
        lines += '\n';
        time += row;
    };
    for (const BootPacket& packet : packets)
        add(packet);
    add(boot_end());
    errno = 0;
    const int descriptor = open_new_file(file, O_APPEND);
    if (descriptor < 0)
        throw InputError(file, "--script", "cannot be written: " + why_not_written(errno),
                         "a place in a folder that exists and may be written");
    ::close(descriptor);
    write_file(file, lines);
    fmt::print("{} rows, {:.2f} s to {:.2f} s: {}\n", packets.size(), at, time, file);
}

void run_upload(const UploadOptions& options, int& status) {
    if (options.port.empty() == options.script.empty())
        throw InputError("", "upload", "one way to send it is needed", "a PORT or --script FILE");
    const auto packets = boot_packets(image::load_image(options.image));
    if (!options.script.empty()) {
        write_script(packets, options.script, options.at, options.baud);
    } else {
        const bool terminal = ::isatty(STDERR_FILENO) == 1;
        upload(options.port, packets, options.baud, options.wait, [terminal](double share) {
            if (terminal) fmt::print(stderr, "\r{:3.0f} %", 100 * share);
        });
        if (terminal) fmt::print(stderr, "\r     \r");
        fmt::print("{} rows, and the program starts\n", packets.size());
    }
    status = 0;
}

}  // namespace

void declare_upload(Command& app, int& status) {
    Command* command = app.add_subcommand("upload", about("upload"));
    auto options = std::make_shared<UploadOptions>();
    command->add_option("image", options->image, "program for the main board: HEX, ELF or COFF")
        ->required()
        ->type_name("IMAGE");
    command->add_option("port", options->port, "serial port, such as a run's pty")->type_name("PORT");
    command
        ->add_option("--wait", options->wait,
                     "s to ask for the boot loader: it listens for a second after a reset")
        ->check(number_between(0.1, 3600))
        ->type_name("S");
    command
        ->add_option("--baud", options->baud,
                     "bits/s of the port (default 115200, as of the original boot loader and of a Bluetooth "
                     "serial port)")
        ->check(number_between(1, 4e6))
        ->type_name("RATE");
    command
        ->add_option("--script", options->script,
                     "writes what to send as a script for uart1 or a Bluetooth computer instead")
        ->type_name("FILE");
    command->add_option("--at", options->at, "s: when the script asks for the boot loader")
        ->check(number_between(0, 1e6))
        ->type_name("S");
    command->callback([options, &status] { run_upload(*options, status); });
}

}  // namespace puckloop::tools
