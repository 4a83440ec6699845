#include "traces/decoders/decoders.h"

#include <fmt/format.h>

#include <span>

namespace puckloop::tools {

namespace {

struct Register {
    int number = 0;
    std::string_view name;
};

struct Device {
    std::uint8_t address = 0;
    std::string_view name;
    bool has_registers = true;
    std::span<const Register> read, written;
};

// The e-RandB range-and-bearing board: range-and-bearing fact sheet, section 2.1.
constexpr Register kRabRead[] = {{0, "POP"},          {1, "DATA_15_8"},   {2, "DATA_7_0"},
                                 {3, "BEARING_HIGH"}, {4, "BEARING_LOW"}, {5, "STRENGTH_HIGH"},
                                 {6, "STRENGTH_LOW"}, {7, "PEAK_HIGH"},   {8, "PEAK_LOW"},
                                 {9, "SENSOR"},       {10, "DATA_31_24"}, {11, "DATA_23_16"}};
constexpr Register kRabWritten[] = {
    {0, "EMITTER_0"},   {1, "EMITTER_1"},   {2, "EMITTER_2"}, {3, "EMITTER_3"},  {4, "EMITTER_4"},
    {5, "EMITTER_5"},   {6, "EMITTER_6"},   {7, "EMITTER_7"}, {8, "EMITTER_8"},  {9, "EMITTER_9"},
    {10, "EMITTER_10"}, {11, "EMITTER_11"}, {12, "RANGE"},    {13, "AUX"},       {14, "SEND_ALL"},
    {15, "SEND_EACH"},  {16, "BASELINE"},   {17, "COMPUTE"},  {20, "AUX_SHIFT"}, {21, "BITS"}};
// The ground sensor board: e-puck fact sheet.
constexpr Register kGround[] = {{0, "REFLECTED_LEFT"}, {2, "REFLECTED_CENTRE"}, {4, "REFLECTED_RIGHT"},
                                {6, "AMBIENT_LEFT"},   {8, "AMBIENT_CENTRE"},   {10, "AMBIENT_RIGHT"},
                                {12, "REVISION"}};
// The main board's camera: what all models share.
constexpr Register kCamera[] = {{0, "DEVICE_ID_H"}, {1, "DEVICE_ID_L"}};
constexpr Device kDevices[] = {{0x20, "rab", true, kRabRead, kRabWritten},
                               {0x60, "ground", true, kGround, kGround},
                               {0x61, "rgb", false, {}, {}},
                               {0x6E, "camera", true, kCamera, kCamera}};

const Device* device_at(std::uint8_t address) {
    for (const Device& device : kDevices)
        if (device.address == address) return &device;
    return nullptr;
}

std::string register_name(std::span<const Register> list, int number) {
    for (const Register& one : list)
        if (one.number == number) return fmt::format("{}({})", one.name, number);
    return fmt::format("register {}", number);
}

}  // namespace

I2cDecoder::I2cDecoder(const FaultMarks& marks, TakeFrame take)
    : marks_(marks), take_(std::move(take)), transfers_([this](const I2cStep& one) { step(one); }) {}

void I2cDecoder::step(const I2cStep& step) {
    using Kind = I2cStep::Kind;
    Open& open = links_[step.link];
    if (step.kind == Kind::Stop) {
        open.frame.end = step.known;
        return give(open);
    }
    if (step.kind == Kind::Start || !open.begun) {
        end_part(open);
        if (!open.begun) {
            open.frame = {step.start, step.known, step.link, step.master, "i2c", {}, {}};
            open.frame.fields["parts"] = nlohmann::ordered_json::array();
        }
        open.begun = true;
        open.address = step.byte >> 1;
        open.reads = (step.byte & 1) != 0;
        open.bytes.clear();
        const Device* device = device_at(open.address);
        open.frame.text += fmt::format("{}0x{:02x}{}{} {}", open.frame.text.empty() ? "" : " | ",
                                       open.address, device == nullptr ? "" : " ",
                                       device == nullptr ? "" : device->name, open.reads ? "read" : "write");
        open.frame.fields["parts"].push_back({{"address", open.address},
                                              {"device", device == nullptr ? "" : std::string(device->name)},
                                              {"read", open.reads}});
    }
    open.frame.end = step.known;
    const auto wrong = [&](const std::string& what) {
        const std::size_t part = open.frame.fields["parts"].size();
        const std::string where = part > 1 ? fmt::format("part {}: ", part) : "";
        open.frame.errors.push_back(where + (step.kind == Kind::Start
                                                 ? fmt::format("address 0x{:02x} {}", open.address, what)
                                                 : fmt::format("byte {} {}", open.bytes.size() + 1, what)));
    };
    if (step.fault != cosim::FaultKind::None) wrong(fmt::format("fault {}", fault_name(step.fault)));
    for (const FaultMark* mark : marks_.of_byte(step.bus, step.start))
        open.frame.errors.push_back("fault " + mark->text());
    if (step.end == I2cStep::End::Lost) {
        wrong("lost the bus");
        return give(open);
    }
    if (step.end == I2cStep::End::Abandoned) {
        wrong("got no answer");
    } else if (!step.acknowledged && step.kind != Kind::Read) {
        wrong("not acknowledged");
    }
    if (step.kind != Kind::Start) open.bytes.push_back(step.byte);
}

/// Puts the bytes since the last START into words.
void I2cDecoder::end_part(Open& open) {
    if (!open.begun) return;
    auto& part = open.frame.fields["parts"].back();
    part["bytes"] = hex_bytes(open.bytes);
    const Device* device = device_at(open.address);
    if (open.bytes.empty() || device == nullptr || !device->has_registers) {
        if (!open.bytes.empty()) open.frame.text += " " + hex_bytes(open.bytes);
        return;
    }
    if (open.reads) {
        const auto pointer = open.pointer.find(open.address);
        if (pointer != open.pointer.end()) {
            part["register"] = pointer->second;
            open.frame.text += " " + register_name(device->read, pointer->second);
        }
        open.frame.text += " = " + hex_bytes(open.bytes);
        return;
    }
    open.pointer[open.address] = open.bytes[0];
    part["register"] = open.bytes[0];
    const std::vector<std::uint8_t> rest(open.bytes.begin() + 1, open.bytes.end());
    if (rest.empty())
        open.frame.text += fmt::format(" select {}", open.bytes[0]);
    else
        open.frame.text +=
            fmt::format(" {} = {}", register_name(device->written, open.bytes[0]), hex_bytes(rest));
}

void I2cDecoder::give(Open& open) {
    if (!open.begun) return;
    end_part(open);
    open.begun = false;
    open.bytes.clear();
    take_(open.frame);
    open.frame = {};
}

void I2cDecoder::end() {
    transfers_.end();
    for (auto& [link, open] : links_) {
        if (open.begun) open.frame.errors.push_back("no STOP before the end of the trace");
        give(open);
    }
}

}  // namespace puckloop::tools
