#include "base/fields/field.h"
#include "cosim/faults/kinds/kind_table.h"
#include "emu/wifi/wifi_settings.h"
#include "physics/tracker/tracker_spec.h"
#include "scenarios/reader/events/action_forms.h"
#include "tools/guide/schema/schema_kit.h"
#include "tools/guide/schema/schemas.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <string>
#include <utility>

namespace puckloop::tools {

namespace {

using nlohmann::ordered_json;

// clang-format off
constexpr SchemaKey kRun[]{
    {"duration", "time", "simulated time; without it the Linux programs end the run"},
    {"seed", "integer", "of every random stream; the same seed gives the same trace"},
    {"record_every", "time", "period of trajectory.csv and sensors.csv; default 100 ms"},
    {"uart_baud", "number", "nominal rate of the UART links; default 115200"},
    {"i2c_clock", "frequency", "SCL of the Linux boards; default 100 kHz"},
    {"ideal_linux_clocks", "flag", "Linux boards of several robots run alike; default false"},
    {"allow", "texts", "failures that leave the run successful: program, silent_line, hung"},
    {"record_ir", "flag", "light of the range-and-bearing boards, chip by chip, in trace.csv"}};
constexpr SchemaKey kArena[]{
    {"size", "lengths2", "length and width of a rectangle round the origin"},
    {"corners", "any", "in place of size: any polygon, [[\"x\", \"y\"], ...]"},
    {"walls", "flag", "default true"}, {"wall_height", "length", "default 10 cm"},
    {"wall_thickness", "length", "default 2 cm"}, {"reflectivity", "ratio", "of the walls; default 1"},
    {"floor_grey", "ratio", "1 is white, 0 black"}};
constexpr SchemaKey kWall[]{
    {"name", "text", ""}, {"from", "lengths2", "one end of its centre line"}, {"to", "lengths2", "the other end"},
    {"thickness", "length", "default 1 cm"}, {"height", "length", "default 10 cm"}, {"reflectivity", "ratio", "default 1"}};
constexpr SchemaKey kBox[]{
    {"name", "text", ""}, {"centre", "lengths2", ""}, {"heading", "angle", "default 0"},
    {"size", "lengths3", "length, width, height"}, {"mass", "mass", "makes it movable"}, {"reflectivity", "ratio", "default 1"}};
constexpr SchemaKey kCylinder[]{
    {"name", "text", ""}, {"centre", "lengths2", ""}, {"radius", "length", ""}, {"height", "length", "default 10 cm"},
    {"mass", "mass", "makes it movable"}, {"reflectivity", "ratio", "default 1"}};
constexpr SchemaKey kLamp[]{
    {"name", "text", ""}, {"centre", "lengths2", ""}, {"height", "length", "of the bulb; default 5 cm"},
    {"intensity", "ratio", "default 1"}};
constexpr SchemaKey kWhoSenses[]{{"robots", "texts", "who senses it; default all"}};
constexpr SchemaKey kVirtualBoard[]{
    {"name", "text", ""}, {"position", "lengths2", ""}, {"heading", "angle", "where the front of its ring looks"},
    {"data", "any", "1 to 4 bytes of payload, the highest first"},
    {"power", "number", "potentiometer byte, 0 (furthest) to 255; default 115"},
    {"begin", "time", "of the first frame"}, {"every", "time", "from one frame to the next; default 100 ms"},
    {"jitter", "time", "standard deviation of a frame's begin; default 2 ms"}};
constexpr SchemaKey kPheromone[]{
    {"name", "text", ""}, {"robots", "texts", "who lays it; default all"},
    {"led", "text", "laid while this LED is lit: led0 to led7, led_front or led_body"},
    {"radius", "length", "of what a robot lays; default 2 cm"},
    {"fill_time", "time", "under a robot until it is full; default 100 ms"},
    {"half_life", "time", "default 30 s; 0: it stays"}, {"diffusion", "number", "m2/s; default 0"},
    {"grey", "ratio", "the floor's, where it is full; default 0"},
    {"cell", "length", "side of the squares that it is computed in; default 1 cm"},
    {"record_every", "time", "rows of pheromones.csv; without it at the end alone"}};
constexpr SchemaKey kSpeaker[]{
    {"name", "text", ""}, {"position", "lengths2", ""}, {"level", "number", "volume in counts of a plain microphone 10 cm before it"},
    {"height", "length", "default 3 cm"}, {"on", "time", "when it begins"}, {"off", "time", "when it ends"},
    {"duration", "time", "in place of off"}, {"every", "time", "it sounds again so much later"},
    {"times", "integer", "so often"}, {"wave", "text", "form of its sound"}, {"tone", "frequency", ""}, {"sweep_to", "frequency", ""}};
constexpr SchemaKey kPatch[]{
    {"name", "text", ""}, {"centre", "lengths2", ""}, {"heading", "angle", ""}, {"grey", "ratio", "1 is white, 0 black"},
    {"shape", "text", "rectangle (default) or disc"}, {"radius", "length", "of a disc"}, {"size", "lengths2", "of a rectangle or an image"},
    {"image", "text", "PNG file in place of grey: its first row is the furthest north"},
    {"stretch", "flag", "the image's pixels need not be square"}};
constexpr SchemaKey kLight[]{{"ambient", "ratio", "0 dark, 1 an ordinary room, 12 the brightest that sensors distinguish"}};
constexpr SchemaKey kRobot[]{
    {"name", "text", "names its nodes, links and log files; default robot0, robot1, ..."},
    {"position", "lengths2", "x east, y north of the arena's centre"}, {"heading", "angle", "from +x counter-clockwise; default 0"},
    {"ground_sensor", "flag", "the I2C board at 0x60; default true"}, {"rgb_turret", "flag", "the I2C board at 0x61; default true"}};
constexpr SchemaKey kPic[]{
    {"firmware", "text", "image (HEX, ELF, COFF): a path relative to this file, \"own\", or a shipped image's name"},
    {"crystal_error", "ratio", "such as \"20 ppm\""}, {"adc_noise", "number", "counts, standard deviation; default 2"},
    {"selector", "integer", "position of the rotary selector, 0..15"},
    {"uart1", "text", "plugged in: script:FILE, pty or tcp:PORT"}, {"uart2", "text", "likewise, without a Linux board"},
    {"reset", "texts", "times at which the reset button is pressed"}, {"nvm", "text", "file that keeps flash and EEPROM"},
    {"boot", "time", "until the firmware listens"}, {"camera", "text", "po3030k, po6030k, po8030d or none"},
    {"camera_turned", "flag", "it lies on its side"}, {"board", "text", "revision: 1.2 or 1.3"},
    {"errata", "texts", "of the chip"}, {"i2c_slave", "flag", "the Linux board can address it; default: by its image"}};
constexpr SchemaKey kModule[]{
    {"number", "integer", ""}, {"name", "text", "that others see"}, {"pin", "text", ""}, {"address", "text", "08:00:17:2C:00:01"},
    {"mode", "text", "automatic or command"}, {"boot", "time", "from reset to READY"}, {"computer", "text", "at the other end: pty, tcp:PORT, script:FILE"},
    {"connect", "time", "when the computer begins to link"}};
constexpr SchemaKey kRab[]{
    {"firmware", "text", "image for the dsPIC33FJ256GP710"}, {"crystal_error", "ratio", ""},
    {"adc_noise", "number", "counts; default 1"}, {"nvm", "text", "file that keeps flash"}};
constexpr SchemaKey kProgram[]{
    {"program", "texts", "path and arguments; a bare name is looked for beside puckloop, then in PATH"},
    {"hostname", "text", ""}, {"start", "time", "default 0"}, {"restart", "texts", "times at which it is killed and started again"},
    {"folder", "text", "to work in, below the results"},
    {"end_signal", "text", "when the run ends; default TERM"}, {"grace", "time", "from the end signal to SIGKILL; default 2 s"},
    {"tty_batch", "time", ""}, {"i2c_hold", "time", ""}, {"oversleep", "time", ""}, {"oversleep_jitter", "time", ""},
    {"clock_error", "ratio", "of its clocks, such as \"20 ppm\""}};
constexpr SchemaKey kSignal[]{{"at", "time", ""}, {"send", "text", "INT, TERM, USR1, ..."}};
constexpr SchemaKey kLinux[]{
    {"arguments", "texts", "more of them, after program's or --linux's"}, {"cameras", "texts", "omni, front"}, {"camera_devices", "texts", "such as /dev/video1"},
    {"serial_devices", "texts", "names of the line to the main board; default /dev/ttyS0"},
    {"i2c_devices", "texts", "names of the robot's bus; default /dev/i2c-3"},
    {"address", "text", "on the network; default by the robot's number"},
    {"save_frames", "integer", "every so-many-th frame is kept as a picture"}};
constexpr SchemaKey kIrcom[]{{"record", "flag", "every edge of light in trace.csv"}};
constexpr SchemaKey kTam[]{
    {"name", "text", "default tam0, tam1, ..."}, {"position", "lengths2", "of its middle"}, {"heading", "angle", "the way its opening looks"},
    {"reflectivity", "ratio", "of its walls"}, {"firmware", "text", "image for the ATmega1284P, or \"own\""},
    {"boot_loader", "text", "image below the firmware"}, {"network", "integer", "DIP switches, 0..3"}, {"battery", "voltage", "default 3.7 V"},
    {"console", "text", "plugged in: script:FILE, pty or tcp:PORT"}, {"console_baud", "number", "default 57600"},
    {"start", "time", "when it is switched on"}, {"reset", "texts", "times at which its reset button is pressed"},
    {"resonator_error", "ratio", ""}, {"adc_noise", "number", "counts; default 0.5"}};
constexpr SchemaKey kXbee[]{
    {"address", "text", "16 hex digits"}, {"node_id", "text", "NI"}, {"channel", "integer", "CH, 11..26"}, {"boot", "time", "from reset to modem status"}};
constexpr SchemaKey kFitted[]{{"fitted", "flag", "default true"}};
constexpr SchemaKey kRadio[]{
    {"range", "length", "default 30 m"}, {"exponent", "number", "by which power falls with distance"}, {"loss", "ratio", ""}, {"processing", "time", ""}};
constexpr SchemaKey kCoordinator[]{
    {"position", "lengths2", ""}, {"network", "integer", "0..3"}, {"uart", "text", "plugged in: script:FILE, pty or tcp:PORT"},
    {"baud", "number", "default 9600"}, {"tty", "text", "default /dev/ttyUSB0"}};
constexpr SchemaKey kBluetooth[]{
    {"range", "length", ""}, {"discovery", "time", ""}, {"name_time", "times2", "mean, standard deviation"},
    {"link_time", "times2", ""}, {"release_time", "times2", ""}};
constexpr SchemaKey kNetwork[]{
    {"mode", "text", "perfect (default), fixed or wifi"}, {"address", "text", "default 10.0.0.0/24"},
    {"latency", "time", "default 0.1 ms, fixed 1 ms, wifi 0.5 ms"}, {"rate", "text", "fixed: of the channel; default 11 Mbit/s"},
    {"queue", "integer", "fixed, wifi: packets that an interface keeps; default 1000"},
    {"access_point", "lengths2", "wifi: where it is; without one stations send to each other"}};
constexpr SchemaKey kHost[]{{"name", "text", "default host0, host1, ..."}, {"address", "text", "on the network"},
    {"position", "lengths2", "wifi: of its radio; without one it is wired to the access point"}};
constexpr SchemaKey kGroup[]{
    {"of", "text", "robot (default), box, cylinder or lamp"}, {"count", "integer", "1 to 1000 units"},
    {"first", "integer", "number of the first one; default 0"},
    {"name", "text", "{n} is the number, here and in any text of a unit"}, {"names", "texts", "in place of name, first and count"}};
constexpr SchemaKey kPlace[]{
    {"kind", "text", "arena (default), disc, rectangle, normal, grid, ring or list"}, {"centre", "lengths2", "of the region"},
    {"radius", "length", "of a disc or ring"}, {"size", "lengths2", "of a rectangle"}, {"deviation", "lengths2", "of a normal distribution"},
    {"distance", "lengths2", "between units of a grid"}, {"columns", "integer", ""}, {"rows", "integer", ""},
    {"start", "angle", "of the first unit on a ring"}, {"positions", "any", "of a list: [[\"x\", \"y\"], ...]"},
    {"headings", "any", "of a list"}, {"heading", "text", "an angle, a distribution, or in or out on a ring"},
    {"max_trials", "integer", "until a unit that finds no room is an error; default 1000"}, {"gap", "length", "kept between units"}};
constexpr SchemaKey kMission[]{
    {"kind", "text", "aggregation, shelter, foraging, coverage, grid_exploration or program"},
    {"program", "texts", "program: path and arguments"},
    {"better", "text", "program: more (default) or less of the score"},
    {"timeout", "time", "program: wall time for an answer; default 10 s"},
    {"begin", "time", "steps count from here on; default 0"}, {"step", "time", "default 100 ms"},
    {"at_end", "flag", "aggregation, shelter: the share of robots at the end"},
    {"cells", "integer", "grid_exploration: rows and columns; default 10"}};
constexpr SchemaKey kRegion[]{
    {"shape", "text", "rectangle (default) or disc"}, {"centre", "lengths2", "default the arena's"},
    {"size", "lengths2", "of a rectangle"}, {"radius", "length", "of a disc"}};
constexpr SchemaKey kExpect[]{
    {"name", "text", "for people; made from the other keys where there is none"},
    {"log", "text", "a node, in whose log a line has `text`"}, {"text", "text", "to be found in a line of the log, or of `trace decode` for a frame"},
    {"link", "text", "a serial line that carries `bytes`"}, {"bytes", "text", "hexadecimal: 56 0D"}, {"from", "text", "the node that sends the bytes or frame"},
    {"robot", "text", "that is in a region"}, {"no_reset", "text", "a board that starts once"},
    {"board", "text", "whose chip holds what `holds` says"}, {"holds", "text", "TRISD == 16, U2STA.OERR == 1, counter >= 3 (a variable), 0x850:4 != 0 (memory)"},
    {"every", "time", "from one look at the chip to the next; default 1 ms"},
    {"frame", "text", "a protocol of `trace decode`, of which a frame comes"}, {"has", "table", "fields that the frame has, as `trace decode --json` names them"},
    {"at_least", "integer", "so many such frames; default 1"}, {"no_loss", "text", "a serial line that loses no character"},
    {"shape", "text", "rectangle (default) or disc"}, {"centre", "lengths2", "of the region"}, {"size", "lengths2", "of a rectangle"}, {"radius", "length", "of a disc"},
    {"after", "time", "not before"}, {"by", "time", "at the latest"}, {"seen", "flag", "false: it must not happen"}};
constexpr SchemaKey kCan[]{{"name", "text", ""}, {"controllers", "texts", "robot0.pic.can1, ..."}};
constexpr SchemaKey kFault[]{
    {"name", "text", ""}, {"link", "text", "robot0.uart, robot0.i2c, ..."}, {"node", "text", "robot0.pic, ..."},
    {"from", "text", "the end whose messages suffer"}, {"at", "time", ""}, {"begin", "time", ""}, {"end", "time", ""}, {"for", "time", "in place of end"},
    {"count", "integer", "at most so often"}, {"probability", "ratio", ""}, {"period", "time", ""},
    {"p", "ratio", "Gilbert-Elliott: into a burst"}, {"r", "ratio", "out of it"}, {"1-h", "ratio", "loss within"}, {"1-k", "ratio", "loss outside"},
    {"skip", "integer", "so many first ones do not suffer"}, {"every", "integer", "only each so-many-th suffers"},
    {"bytes", "texts", ""}, {"position", "integer", ""}, {"match", "text", "bytes in hexadecimal"}, {"offset", "integer", ""},
    {"may_not_fire", "flag", "no warning if it never fires"}};
constexpr SchemaKey kWhen[]{
    {"robot", "text", ""}, {"after", "text", "label of an event"}, {"near", "text", ""}, {"distance", "length", ""}, {"enters", "lengths2", ""}, {"radius", "length", ""},
    {"size", "lengths2", ""}, {"travels", "length", ""}, {"led", "text", ""}, {"on", "flag", ""}, {"wheels", "text", "turn or stop"}};
constexpr SchemaKey kEvent[]{
    {"label", "text", ""}, {"at", "time", ""}, {"every", "time", ""}, {"delay", "time", "behind its condition"}, {"count", "integer", "so often"}};
// clang-format on

/// Physical parameters by their dotted names, as tables in tables (puckloop run --list-parameters).
ordered_json parameters_schema() {
    return {{"type", "object"},
            {"description", "physical parameters (puckloop run --list-parameters)"},
            {"additionalProperties", true}};
}

ordered_json program_schema(std::string_view about, std::span<const SchemaKey> more) {
    ordered_json table = table_schema(about, kProgram, {"program"});
    add_keys(table, more);
    table["properties"]["signals"] =
        list_schema(table_schema("signals that it gets", kSignal, {"at", "send"}));
    return table;
}

ordered_json robot_schema() {
    ordered_json pic = table_schema("the main board", kPic, {"firmware"});
    pic["properties"]["bluetooth"] = table_schema("the Bluetooth module on UART1", kModule);
    ordered_json robot = table_schema("an e-puck", kRobot, {"position", "pic"});
    ordered_json& properties = robot["properties"];
    properties["pic"] = std::move(pic);
    properties["rab"] = table_schema("the range-and-bearing board", kRab, {"firmware"});
    properties["linux"] = program_schema("the Linux board and its program", kLinux);
    properties["linux"].erase("required");  // `arguments` alone go with --linux
    properties["parameters"] = parameters_schema();
    return robot;
}

ordered_json xbee_schema(std::span<const SchemaKey> more) {
    ordered_json xbee = table_schema("radio module", kXbee);
    add_keys(xbee, more);
    xbee["properties"]["parameters"] = {{"type", "object"},
                                        {"description", "AT parameters"},
                                        {"additionalProperties", {{"type", "integer"}}}};
    return xbee;
}

ordered_json tam_schema() {
    ordered_json tam = table_schema("a TAM: booth and board", kTam, {"position"});
    tam["properties"]["xbee"] = xbee_schema(kFitted);
    return tam;
}

ordered_json coordinator_schema() {
    ordered_json place = program_schema("the coordinator's radio module and computer", kCoordinator);
    place.erase("required");
    place["properties"].update(xbee_schema({})["properties"]);
    return place;
}

ordered_json host_schema() {
    return program_schema("a computer on the network and its program", kHost);
}

/// What an event does comes from the table of commands; a new thing has the keys of its own table.
ordered_json event_schema() {
    ordered_json event = table_schema("something that happens to the world", kEvent);
    ordered_json& properties = event["properties"];
    properties["when"] = table_schema("a condition, in place of a time", kWhen);
    for (const scenarios::ActionForm& form : scenarios::action_forms()) {
        properties[std::string(form.verb)] = {{"type", "string"}, {"description", form.help}};
        for (const scenarios::ActionKey& key : form.keys)
            if (!properties.contains(key.name)) properties[std::string(key.name)] = ordered_json::object();
    }
    for (const scenarios::ThingForm& form : scenarios::thing_forms())
        for (const scenarios::ActionKey& key : form.keys)
            if (!properties.contains(key.name)) properties[std::string(key.name)] = ordered_json::object();
    return event;
}

/// In place of a value that is no text: the text of a pattern.
ordered_json or_text(ordered_json value, const char* pattern) {
    return {{"anyOf", {std::move(value), {{"type", "string"}, {"pattern", pattern}}}}};
}

/// Lets a text like `pattern` stand wherever a value does, as a variable may.
void allow_text(ordered_json& schema, const char* pattern) {
    if (schema.contains("properties"))
        for (ordered_json& property : schema["properties"])
            allow_text(property, pattern);
    else if (schema.contains("items"))
        allow_text(schema["items"], pattern);
    else if (schema.contains("type") && schema["type"] == "string" && !schema.contains("pattern"))
        return;  // any text is one
    else if (schema.contains("anyOf"))
        schema["anyOf"].push_back({{"type", "string"}, {"pattern", pattern}});
    else if (schema.contains("type") || schema.contains("enum")) {
        ordered_json about = schema.contains("description") ? schema["description"] : ordered_json();
        schema.erase("description");
        schema = or_text(schema, pattern);
        if (!about.is_null()) schema["description"] = about;
    }
}

/// A group has its units' keys, without where they are; their values may be drawn.
ordered_json group_schema() {
    ordered_json group = robot_schema();
    group["description"] = "many of one kind, placed and spread by the seed (docs/swarm.md)";
    group.erase("required");
    add_keys(group, kBox);
    add_keys(group, kCylinder);
    add_keys(group, kLamp);
    for (const char* key : {"position", "centre", "heading"})
        group["properties"].erase(key);
    add_keys(group, kGroup);
    group["properties"]["place"] = table_schema("where the units are", kPlace);
    allow_text(group, "^(normal|uniform|choice)\\(");
    return group;
}

}  // namespace

// Kinds and their keys come from the table that carries them out.
ordered_json fault_schema() {
    ordered_json fault = table_schema("a fault of a link or node (docs/faults.md)", kFault);
    std::set<std::string> kinds;
    for (const cosim::KindInfo& kind : cosim::all_kinds()) {
        kinds.emplace(kind.name);
        if (!kind.alias.empty()) kinds.emplace(kind.alias);
        for (const cosim::ParameterInfo& parameter : kind.parameters) {
            ordered_json& property = fault["properties"][std::string(parameter.key)];
            if (property.is_null()) property = ordered_json::object();
        }
    }
    fault["properties"]["kind"] = {{"type", "string"}, {"enum", kinds}, {"default", "drop"}};
    return fault;
}

namespace {

/// Keys of a struct that lists its fields: numbers with a unit, whole numbers, texts and flags.
template <Described T>
ordered_json fields_schema(std::string_view about) {
    constexpr std::pair<std::string_view, std::string_view> kTypes[]{
        {"s", "time"},    {"m", "length"},   {"rad", "angle"},     {"Hz", "frequency"}, {"dB", "gain"},
        {"dBm", "level"}, {"bit/s", "rate"}, {"slots", "integer"}, {"1", "ratio"}};
    ordered_json table = table_schema(about, {});
    for_each_entry<T>([&](const auto& one) {
        const auto* type = std::find_if(std::begin(kTypes), std::end(kTypes),
                                        [&](const auto& known) { return known.first == one.unit; });
        using Value = std::remove_cvref_t<decltype(std::declval<T>().*one.member)>;
        constexpr std::string_view kPlain = std::is_same_v<Value, std::string> ? "text"
                                            : std::is_same_v<Value, bool>      ? "flag"
                                            : std::is_integral_v<Value>        ? "integer"
                                                                               : "number";
        const SchemaKey key{one.key, type == std::end(kTypes) ? kPlain : type->second, one.about};
        add_keys(table, std::span(&key, 1));
    });
    return table;
}

}  // namespace

ordered_json scenario_schema() {
    ordered_json schema = schema_head("scenario", "a puckloop scenario (docs/scenario.md)");
    schema.update(table_schema("world, robots, TAMs, faults and events of a run", {}));
    ordered_json& properties = schema["properties"];
    properties["run"] = table_schema("length, seed and records", kRun);
    properties["arena"] = table_schema("floor and walls", kArena);
    properties["wall"] = list_schema(table_schema("a wall", kWall, {"from", "to"}));
    properties["box"] = list_schema(table_schema("a box", kBox, {"centre", "size"}));
    properties["cylinder"] = list_schema(table_schema("a cylinder", kCylinder, {"centre", "radius"}));
    properties["lamp"] = list_schema(table_schema("a lamp", kLamp, {"centre"}));
    properties["speaker"] = list_schema(table_schema("a loudspeaker", kSpeaker, {"position", "level"}));
    properties["floor_patch"] = list_schema(table_schema("paper on the floor", kPatch, {"centre"}));
    const auto add_virtual = [&](const char* name, const char* about, std::span<const SchemaKey> keys,
                                 std::initializer_list<std::string_view> required) {
        ordered_json table = table_schema(about, keys, required);
        table["properties"].erase("mass");
        add_keys(table, kWhoSenses);
        properties[name] = list_schema(std::move(table));
    };
    add_virtual("virtual_wall", "what only proximity sensors meet (docs/virtual.md)", kWall, {"from", "to"});
    add_virtual("virtual_box", "likewise", kBox, {"centre", "size"});
    add_virtual("virtual_cylinder", "likewise", kCylinder, {"centre", "radius"});
    add_virtual("virtual_lamp", "what only light sensors see", kLamp, {"centre"});
    properties["virtual_board"] =
        list_schema(table_schema("frames of a range-and-bearing board without a robot (docs/virtual.md)",
                                 kVirtualBoard, {"position", "data"}));
    properties["pheromone"] =
        list_schema(table_schema("a trail that ground sensors see (docs/virtual.md)", kPheromone));
    properties["light"] = table_schema("the room's light", kLight);
    properties["parameters"] = parameters_schema();
    properties["robot"] = list_schema(robot_schema());
    properties["group"] = list_schema(group_schema());
    properties["tam"] = list_schema(tam_schema());
    properties["radio"] = table_schema("the air between radio modules", kRadio);
    properties["coordinator"] = coordinator_schema();
    properties["network"] = table_schema("between Linux boards and hosts (docs/network.md)", kNetwork);
    properties["network"]["properties"]["wifi"] = fields_schema<wifi::WifiSettings>("its radio");
    properties["host"] = list_schema(host_schema());
    properties["bluetooth"] = table_schema("the air between Bluetooth modules", kBluetooth);
    ordered_json mission = table_schema("what the swarm is scored by", kMission, {"kind"});
    mission["properties"]["spot"] = list_schema(table_schema("counted; coverage: forbidden", kRegion));
    mission["properties"]["nest"] = table_schema("foraging: where items go", kRegion);
    mission["properties"]["area"] = table_schema("coverage, grid_exploration: what is covered", kRegion);
    properties["mission"] = std::move(mission);
    properties["tracker"] = fields_schema<physics::TrackerSpec>("cameras above the arena (docs/missions.md)");
    properties["can_bus"] = list_schema(table_schema("wires between CAN modules", kCan, {"controllers"}));
    properties["ircom"] = table_schema("words by the light of proximity sensors", kIrcom);
    properties["fault"] = list_schema(fault_schema());
    properties["event"] = list_schema(event_schema());
    properties["expect"] = list_schema(table_schema("what the run has to do (docs/expect.md)", kExpect));
    allow_text(schema, R"(\$\{)");
    properties["include"] = value_schema("texts", "files whose tables are read first");
    properties["variables"] = {{"type", "object"},
                               {"description", "the value of ${NAME}; --set NAME=VALUE replaces it"},
                               {"additionalProperties", true}};
    return schema;
}

}  // namespace puckloop::tools
