-- What puckloop's pcapng files hold beyond what Wireshark knows itself (docs/sigrok.md):
--   e-puck records   serial packets of a main board (*.pic) and its Linux program: epuck.*
--   XBee API frames  serial packets of a module (*.xbee) and its host: xbee.*
--   Bluetooth        serial packets of a main board and its LMX9820A (*.bluetooth): lmx9820.*
--   registers        I2C transfers of the range-and-bearing board, the ground sensor and the camera: epuck_i2c.*
--   mesh frames      the network header in 802.15.4 frames of XBee modules: xbee_mesh.*
--
--   wireshark -X lua_script:puckloop.lua run.pcapng
--
-- It runs after the other dissectors and knows links by the names of the interfaces: "robot0.uart robot0.pic" is a
-- link and the node that sends. Records that are cut into several packets are shown in the last one; each link is
-- read in the order of the file. Lua 5.1 to 5.4.

local SERIAL, I2C = wtap_encaps.RTAC_SERIAL, wtap_encaps.I2C_LINUX
local SERIAL_HEADER = 12 -- time stamp, event, control lines, two bytes that are not used
local FRAMING_ERROR, PARITY_ERROR, BREAK = 7, 8, 9
local LONGEST_PAUSE = 0.02 -- seconds within a sensor record; the board was reset where it lasts longer
local BYTE_TIME = 10 / 115200

local field_of = {
    encap = Field.new("frame.encap_type"),
    interface = Field.new("frame.interface_name"),
    comment = Field.new("frame.comment"),
}

local function text_of(name)
    local info = field_of[name]()
    return info and tostring(info.value) or ""
end

-- Results of packets that were seen once, by the number of the packet; and what the links carried so far.
local results, links = {}, {}

local function number(text, at, size, signed)
    local value = 0
    for place = size - 1, 0, -1 do
        value = value * 256 + text:byte(at + 1 + place)
    end
    if signed and value >= 2 ^ (8 * size - 1) then
        value = value - 2 ^ (8 * size)
    end
    return value
end

local function hex(text)
    return (text:gsub(".", function(c)
        return ("%02x"):format(c:byte())
    end))
end

local function bytes_of(text)
    return ByteArray.new(hex(text))
end

-- e-puck records ------------------------------------------------------------------------------------------------

local epuck = Proto("epuck", "e-puck record")

-- Of each record: name of the field, its type, how many.
local LAYOUT = {
    session = { { "wake_up", "uint8", 1 }, { "session_rab_range", "uint8", 1 }, { "rab_enabled", "uint8", 1 },
        { "padding", "uint16", 1 } },
    actuators = { { "left", "int16", 1 }, { "right", "int16", 1 }, { "send_rab_data", "uint16", 1 },
        { "ring_leds", "uint8", 1 }, { "other_leds", "uint8", 1 }, { "ircom_enabled", "uint8", 1 },
        { "send_ircom_data", "uint8", 1 }, { "reset", "uint8", 1 }, { "padding", "uint8", 1 } },
    sensors = { { "rab_data", "uint16", 1 }, { "rab_range", "uint16", 1 }, { "rab_bearing", "float", 1 },
        { "proximity", "int16", 8 }, { "battery_ok", "uint16", 1 }, { "accelerometer", "int16", 3 },
        { "microphone", "int16", 4 }, { "light", "int16", 8 }, { "rab_received", "uint16", 1 },
        { "ircom_received", "uint16", 1 }, { "ircom_data", "uint8", 1 }, { "padding", "uint8", 1 },
        { "ircom_sensor", "uint16", 1 }, { "ircom_range", "float", 1 }, { "ircom_bearing", "float", 1 } },
}
local SIZE_OF = { uint8 = 1, uint16 = 2, int16 = 2, float = 4 }
local RECORD_BYTES = { session = 5, actuators = 12, sensors = 72 }
local HEXADECIMAL = { ring_leds = true, other_leds = true, rab_data = true, send_rab_data = true, ircom_data = true,
    send_ircom_data = true, wake_up = true }

local epuck_fields = {
    record = ProtoField.string("epuck.record", "Record"),
    out_of_step = ProtoField.bytes("epuck.incomplete", "Bytes of no whole record"),
    frame = ProtoField.framenum("epuck.packet", "Part of it in packet"),
}
for _, layout in pairs(LAYOUT) do
    for _, one in ipairs(layout) do
        local name, kind = one[1], one[2]
        if kind == "float" then
            epuck_fields[name] = ProtoField.float("epuck." .. name, name)
        else
            epuck_fields[name] = ProtoField[kind]("epuck." .. name, name,
                HEXADECIMAL[name] and base.HEX or base.DEC)
        end
    end
end
epuck.fields = epuck_fields
local epuck_wrong = ProtoExpert.new("epuck.wrong", "e-puck record", expert.group.MALFORMED, expert.severity.ERROR)
epuck.experts = { epuck_wrong }

local function implausible(record, bytes)
    if record == "actuators" then
        local reset = bytes:byte(11)
        if reset ~= 0x4E and reset ~= 0x52 then
            return ("reset is %02x, neither N nor R"):format(reset)
        end
        return nil
    elseif record ~= "sensors" then
        return nil
    end
    local limits = { proximity = { -4095, 4095 }, light = { 0, 4095 }, accelerometer = { -4095, 4095 },
        microphone = { -4095, 4095 }, battery_ok = { 0, 1 }, rab_received = { 0, 1 }, ircom_received = { 0, 1 },
        ircom_sensor = { 0, 7 }, padding = { 0, 0 } }
    local at = 0
    for _, one in ipairs(LAYOUT.sensors) do
        local name, kind, count = one[1], one[2], one[3]
        for _ = 1, count do
            local size = SIZE_OF[kind]
            local limit = limits[name]
            if limit then
                local value = number(bytes, at, size, kind == "int16")
                if value < limit[1] or value > limit[2] then
                    return ("implausible: %s is outside %d..%d"):format(name, limit[1], limit[2])
                end
            elseif kind == "float" and math.floor(number(bytes, at + 2, 2) / 128) % 256 == 255 then
                return ("implausible: %s is not a number"):format(name)
            end
            at = at + size
        end
    end
    return nil
end

local function summary(record, bytes)
    if record == "session" then
        return ("session wake-up %02x rab_range %d rab_enabled %d"):format(bytes:byte(1, 3))
    elseif record == "actuators" then
        local reset = bytes:byte(11)
        return ("actuators left %d right %d ring %02x leds %x rab %04x ircom %d:%02x reset %s"):format(
            number(bytes, 0, 2, true), number(bytes, 2, 2, true), bytes:byte(7), bytes:byte(8), number(bytes, 4, 2),
            bytes:byte(9), bytes:byte(10),
            reset >= 32 and reset < 127 and string.char(reset) or ("%02x"):format(reset))
    end
    local proximity = {}
    for i = 0, 7 do
        proximity[#proximity + 1] = ("%d"):format(number(bytes, 8 + 2 * i, 2, true))
    end
    local text = "sensors proximity " .. table.concat(proximity, " ")
    if number(bytes, 56, 2) ~= 0 then
        text = text .. (" rab %04x range %d"):format(number(bytes, 0, 2), number(bytes, 2, 2))
    end
    if number(bytes, 58, 2) ~= 0 then
        text = text .. (" ircom %02x sensor %d"):format(bytes:byte(61), number(bytes, 62, 2))
    end
    return text
end

local function new_part()
    return { bytes = "", packets = {}, notes = {}, ended = 0 }
end

local function give(found, part, record, note)
    if note then
        part.notes[#part.notes + 1] = note
    end
    part.protocol, part.record = "epuck", record
    if record then
        local why = implausible(record, part.bytes)
        if why then
            part.notes[#part.notes + 1] = why
        end
    end
    found[#found + 1] = part
end

-- Adds a packet's bytes to a link and returns what became complete by it.
local function take_epuck(link, from_linux, bytes, note, packet, time)
    local found = {}
    link.expected = link.expected or "session"
    link.linux, link.board = link.linux or new_part(), link.board or new_part()
    if not from_linux and #link.linux.bytes > 0 then
        give(found, link.linux, nil,
            ("%d bytes left when the main board answered: out of step"):format(#link.linux.bytes))
        link.linux, link.expected = new_part(), "actuators"
    end
    if not from_linux and #link.board.bytes > 0 and time > link.board.ended + LONGEST_PAUSE then
        give(found, link.board, nil, ("%d of 72 bytes, then silence"):format(#link.board.bytes))
        link.board = new_part()
    end
    local side = from_linux and "linux" or "board"
    for i = 1, #bytes do
        local part = link[side]
        part.bytes = part.bytes .. bytes:sub(i, i)
        if part.packets[#part.packets] ~= packet then
            part.packets[#part.packets + 1] = packet
        end
        if note then
            part.notes[#part.notes + 1] = ("byte %d: %s"):format(#part.bytes, note)
        end
        part.ended = time + i * BYTE_TIME
        local record = from_linux and link.expected or "sensors"
        if #part.bytes == RECORD_BYTES[record] then
            give(found, part, record)
            link[side] = new_part()
            if from_linux then
                local ends = record == "actuators" and part.bytes:byte(11) == 0x52
                link.expected = ends and "session" or "actuators"
                if record == "actuators" and #link.board.bytes > 0 then
                    give(found, link.board, nil,
                        ("%d of 72 bytes when Linux sent its next record"):format(#link.board.bytes))
                    link.board = new_part()
                end
            end
        end
    end
    return found
end

local function show_epuck(part, pinfo, tree)
    local tvb = bytes_of(part.bytes):tvb("e-puck record")
    local title = part.record and summary(part.record, part.bytes) or "incomplete " .. hex(part.bytes)
    local item = tree:add(epuck, tvb(), "e-puck " .. title)
    for _, note in ipairs(part.notes) do
        item:add_proto_expert_info(epuck_wrong, note)
    end
    if part.record then
        item:add(epuck_fields.record, part.record):set_generated()
        local at = 0
        for _, one in ipairs(LAYOUT[part.record]) do
            local name, size, count = one[1], SIZE_OF[one[2]], one[3]
            for i = 0, count - 1 do
                local line = item:add_le(epuck_fields[name], tvb(at, size))
                if count > 1 then
                    line:prepend_text(("[%d] "):format(i))
                end
                at = at + size
            end
        end
    else
        item:add(epuck_fields.out_of_step, tvb())
    end
    for _, packet in ipairs(part.packets) do
        if packet ~= pinfo.number then
            item:add(epuck_fields.frame, packet):set_generated()
        end
    end
    return title
end

-- XBee API frames -----------------------------------------------------------------------------------------------

local xbee = Proto("xbee", "XBee API frame")
local xbee_fields = {
    type = ProtoField.uint8("xbee.type", "Type", base.HEX),
    name = ProtoField.string("xbee.name", "Name"),
    id = ProtoField.uint8("xbee.id", "Frame id"),
    command = ProtoField.string("xbee.command", "AT command"),
    value = ProtoField.bytes("xbee.value", "Value"),
    to = ProtoField.uint64("xbee.to", "To", base.HEX),
    from = ProtoField.uint64("xbee.from", "From", base.HEX),
    net = ProtoField.uint16("xbee.net", "16-bit address", base.HEX),
    radius = ProtoField.uint8("xbee.radius", "Radius"),
    options = ProtoField.uint8("xbee.options", "Options", base.HEX),
    status = ProtoField.uint8("xbee.status", "Status", base.HEX),
    retries = ProtoField.uint8("xbee.retries", "Retries"),
    delivery = ProtoField.uint8("xbee.delivery", "Delivery", base.HEX),
    discovery = ProtoField.uint8("xbee.discovery", "Discovery", base.HEX),
    data = ProtoField.bytes("xbee.data", "Data"),
}
xbee.fields = xbee_fields
xbee.prefs.mode = Pref.enum("API mode", 2, "The module's parameter AP",
    { { 1, "1: plain", 1 }, { 2, "2: escaped", 2 } }, false)
local xbee_wrong = ProtoExpert.new("xbee.wrong", "XBee frame", expert.group.MALFORMED, expert.severity.ERROR)
xbee.experts = { xbee_wrong }

-- Of each type: its name and fields, with their bytes; 0 is the rest.
local XBEE = {
    [0x08] = { "at", { "id", 1, "command", 2, "value", 0 } },
    [0x09] = { "queued-at", { "id", 1, "command", 2, "value", 0 } },
    [0x10] = { "tx", { "id", 1, "to", 8, "net", 2, "radius", 1, "options", 1, "data", 0 } },
    [0x17] = { "remote-at", { "id", 1, "to", 8, "net", 2, "options", 1, "command", 2, "value", 0 } },
    [0x88] = { "at-response", { "id", 1, "command", 2, "status", 1, "value", 0 } },
    [0x8A] = { "modem-status", { "status", 1 } },
    [0x8B] = { "tx-status", { "id", 1, "net", 2, "retries", 1, "delivery", 1, "discovery", 1 } },
    [0x90] = { "rx", { "from", 8, "net", 2, "options", 1, "data", 0 } },
    [0x97] = { "remote-at-response", { "id", 1, "from", 8, "net", 2, "command", 2, "status", 1, "value", 0 } },
}
local MOST_XBEE = 256 -- bytes of data: a module sends at most 73 over the air

local function take_xbee(line, bytes, note, packet)
    local found = {}
    local escapes = xbee.prefs.mode == 2
    local function ends(wrong)
        found[#found + 1] = { protocol = "xbee", bytes = line.data or "", packets = line.packets,
            notes = { wrong or line.note } }
        line.data = nil
    end
    local function noise()
        if line.noise and #line.noise > 0 then
            found[#found + 1] = { protocol = "xbee", bytes = line.noise, packets = {}, notes = { "noise" } }
        end
        line.noise = ""
    end
    for i = 1, #bytes do
        local byte = bytes:byte(i)
        if byte == 0x7E and (escapes or not line.data) then
            noise()
            if line.data then
                ends("restart: a start delimiter inside the frame")
            end
            line.data, line.head, line.escaped, line.packets, line.note = "", {}, false, {}, nil
        elseif not line.data then
            line.noise = (line.noise or "") .. string.char(byte)
        elseif escapes and byte == 0x7D and not line.escaped then
            line.escaped = true
        else
            if line.escaped then
                byte = byte >= 0x80 and byte - 0x80 or byte -- exclusive-or 20, without an operator of Lua 5.3
                byte = math.floor(byte / 0x20) % 2 == 1 and byte - 0x20 or byte + 0x20
                byte = bytes:byte(i) >= 0x80 and byte + 0x80 or byte
                line.escaped = false
            end
            if #line.head < 2 then
                line.head[#line.head + 1] = byte
                local length = #line.head == 2 and line.head[1] * 256 + line.head[2]
                if length and (length == 0 or length > MOST_XBEE) then
                    ends(("length: %d bytes"):format(length))
                end
            elseif #line.data < line.head[1] * 256 + line.head[2] then
                line.data = line.data .. string.char(byte)
            else
                local sum = byte
                for place = 1, #line.data do
                    sum = sum + line.data:byte(place)
                end
                ends(sum % 256 ~= 255 and ("check: %02x does not fit the data"):format(byte) or nil)
            end
        end
        if line.data then
            line.note = line.note or note
            if line.packets[#line.packets] ~= packet then
                line.packets[#line.packets + 1] = packet
            end
        end
    end
    return found
end

local function show_xbee(part, pinfo, tree)
    if #part.bytes == 0 then
        tree:add(xbee, "XBee"):add_proto_expert_info(xbee_wrong, part.notes[1] or "no data")
        return "xbee [" .. (part.notes[1] or "no data") .. "]"
    end
    local tvb = bytes_of(part.bytes):tvb("XBee frame")
    local kind = not part.notes[1] and XBEE[part.bytes:byte(1)] or { "other", { "data", 0 } }
    local least = 1
    for i = 2, #kind[2], 2 do
        least = least + kind[2][i]
    end
    local whole = kind[2][#kind[2]] == 0
    if #part.bytes < least or (not whole and #part.bytes > least) then
        kind = { "other", { "data", 0 } }
    end
    local item = tree:add(xbee, tvb(), "XBee " .. kind[1])
    if part.notes[1] then
        item:add_proto_expert_info(xbee_wrong, part.notes[1])
    end
    item:add(xbee_fields.type, tvb(0, 1))
    item:add(xbee_fields.name, kind[1]):set_generated()
    local at, text = 1, kind[1]
    for i = 1, #kind[2], 2 do
        local name, size = kind[2][i], kind[2][i + 1]
        size = size == 0 and #part.bytes - at or size
        if size > 0 then
            item:add(xbee_fields[name], tvb(at, size))
            local bytes = part.bytes:sub(at + 1, at + size)
            text = text .. " " .. name .. " " .. (name == "command" and bytes or hex(bytes))
        end
        at = at + size
    end
    return text .. (part.notes[1] and " [" .. part.notes[1] .. "]" or "")
end

-- Bluetooth module (LMX9820A) -----------------------------------------------------------------------------------

local lmx = Proto("lmx9820", "LMX9820A packet")
local LMX_TYPES = { [0x52] = "REQ", [0x43] = "CFM", [0x69] = "IND", [0x72] = "RSP" }
local LMX_NAMES = {
    [0x00] = "GAP_INQUIRY", [0x01] = "GAP_DEVICE_FOUND", [0x02] = "GAP_REMOTE_DEVICE_NAME", [0x03] =
    "GAP_READ_LOCAL_NAME", [0x04] = "GAP_WRITE_LOCAL_NAME", [0x05] = "GAP_READ_LOCAL_BDA", [0x06] =
    "GAP_SET_SCANMODE", [0x07] = "SPP_SET_PORT_CONFIG", [0x08] = "SPP_GET_PORT_CONFIG", [0x09] =
    "SPP_PORT_CONFIG_CHANGED", [0x0A] = "SPP_ESTABLISH_LINK", [0x0B] = "SPP_LINK_ESTABLISHED", [0x0C] =
    "SPP_INCOMING_LINK_ESTABLISHED", [0x0D] = "SPP_RELEASE_LINK", [0x0E] = "SPP_LINK_RELEASED", [0x0F] =
    "SPP_SEND_DATA", [0x10] = "SPP_INCOMING_DATA", [0x11] = "SPP_TRANSPARENT_MODE", [0x12] =
    "SPP_CONNECT_DEFAULT_CON", [0x13] = "SPP_STORE_DEFAULT_CON", [0x14] = "SPP_GET_LIST_DEFAULT_CON", [0x15] =
    "SPP_DELETE_DEFAULT_CON", [0x16] = "GAP_GET_FIXED_PIN", [0x17] = "GAP_SET_FIXED_PIN", [0x18] =
    "GAP_GET_SECURITY_MODE", [0x19] = "GAP_SET_SECURITY_MODE", [0x1A] = "RESTORE_FACTORY_SETTINGS", [0x1B] =
    "GAP_REMOVE_PAIRING", [0x1C] = "GAP_LIST_PAIRED_DEVICES", [0x1D] = "FORCE_MASTER_ROLE", [0x1E] =
    "SDAP_SERVICE_REQUEST", [0x1F] = "GET_PORTS_TO_OPEN", [0x20] = "READ_RSSI", [0x21] = "GAP_ENTER_SNIFF_MODE",
    [0x22] = "SET_PORTS_TO_OPEN", [0x23] = "CHANGE_NVS_UART_SPEED", [0x24] = "TEST_MODE", [0x25] = "READY", [0x26]
    = "RESET", [0x27] = "CHANGE_LOCAL_BDADDRESS", [0x28] = "STORE_CLASS_OF_DEVICE", [0x29] = "ENABLE_SDP_RECORD",
    [0x2A] = "DELETE_SDP_RECORDS", [0x2B] = "STORE_SPP_RECORD", [0x2C] = "STORE_DUN_RECORD", [0x2D] =
    "STORE_FAX_RECORD", [0x2E] = "STORE_OPP_RECORD", [0x2F] = "STORE_FTP_RECORD", [0x30] = "STORE_SYNC_RECORD",
    [0x32] = "SDAP_CONNECT", [0x33] = "SDAP_DISCONNECT", [0x34] = "SDAP_CONNECTION_LOST", [0x35] =
    "SDAP_SERVICE_BROWSE", [0x36] = "SDAP_SERVICE_SEARCH", [0x37] = "GAP_EXIT_SNIFF_MODE", [0x38] =
    "GAP_ENTER_PARK_MODE", [0x39] = "GAP_EXIT_PARK_MODE", [0x3A] = "GAP_ENTER_HOLD_MODE", [0x3B] =
    "GAP_SET_LINK_POLICY", [0x3C] = "GAP_GET_LINK_POLICY", [0x3D] = "GAP_POWER_SAVE_MODE_CHANGED", [0x3E] =
    "SPP_PORT_STATUS_CHANGED", [0x3F] = "SDAP_ATTRIBUTE_REQUEST", [0x40] = "SPP_GET_PORT_STATUS", [0x41] =
    "SPP_PORT_SET_DTR", [0x42] = "SPP_PORT_SET_RTS", [0x43] = "SPP_PORT_BREAK", [0x44] = "SPP_PORT_OVERRUN_ERROR",
    [0x45] = "SPP_PORT_PARITY_ERROR", [0x46] = "SPP_PORT_FRAMING_ERROR", [0x47] = "FIRMWARE_UPGRADE", [0x48] =
    "CHANGE_UART_SETTINGS", [0x49] = "READ_OPERATION_MODE", [0x4A] = "WRITE_OPERATION_MODE", [0x4B] =
    "RF_TEST_MODE", [0x4C] = "SET_DEFAULT_LINK_POLICY", [0x4D] = "GET_DEFAULT_LINK_POLICY", [0x4E] =
    "SET_EVENT_FILTER", [0x4F] = "GET_EVENT_FILTER", [0x50] = "GAP_ACL_ESTABLISHED", [0x51] =
    "GAP_ACL_TERMINATED", [0x52] = "DISABLE_TL", [0x53] = "TL_ENABLED", [0x55] = "SET_DEFAULT_LINK_TIMEOUT",
    [0x56] = "GET_DEFAULT_LINK_TIMEOUT", [0x57] = "SPP_SET_LINK_TIMEOUT", [0x58] = "SPP_GET_LINK_TIMEOUT"
}
local MOST_LMX = 333 -- bytes of data
local lmx_fields = {
    type = ProtoField.uint8("lmx9820.type", "Type", base.HEX, LMX_TYPES),
    opcode = ProtoField.uint8("lmx9820.opcode", "Opcode", base.HEX, LMX_NAMES),
    length = ProtoField.uint16("lmx9820.length", "Length of the data"),
    status = ProtoField.uint8("lmx9820.status", "Status", base.HEX),
    data = ProtoField.bytes("lmx9820.data", "Data"),
}
lmx.fields = lmx_fields
local lmx_wrong = ProtoExpert.new("lmx9820.wrong", "LMX9820A packet", expert.group.MALFORMED, expert.severity.ERROR)
lmx.experts = { lmx_wrong }

-- 02, type, opcode, length of the data (low byte first), sum of the four, data, 03. Bytes between packets are what
-- passes the module transparently.
local function take_lmx(line, bytes, packet)
    local found = {}
    local function ends(wrong)
        found[#found + 1] = { protocol = "lmx", bytes = line.data, packets = line.packets, notes = { wrong } }
        line.data = nil
    end
    for i = 1, #bytes do
        local c = bytes:sub(i, i)
        if line.data then
            line.data = line.data .. c
            local size = #line.data
            local length = size >= 5 and line.data:byte(4) + 256 * line.data:byte(5) or 0
            if size == 2 and not LMX_TYPES[c:byte()] then
                ends("unknown type")
            elseif size == 5 and length > MOST_LMX then
                ends(("%d bytes of data"):format(length))
            elseif size == 6 then
                local sum = line.data:byte(2) + line.data:byte(3) + line.data:byte(4) + line.data:byte(5)
                if sum % 256 ~= c:byte() then
                    ends(("check: %02x, and the head needs %02x"):format(c:byte(), sum % 256))
                end
            elseif size > 6 and size == length + 7 then
                ends(c ~= "\3" and "no 03 at the end" or nil)
            end
            if not line.data and c == "\2" and found[#found].notes[1] then
                line.data, line.packets = c, {}
            end
        elseif c == "\2" then
            line.data, line.packets = c, {}
        end
        if line.data and line.packets[#line.packets] ~= packet then
            line.packets[#line.packets + 1] = packet
        end
    end
    return found
end

local function show_lmx(part, _, tree)
    local tvb = bytes_of(part.bytes):tvb("LMX9820A packet")
    local item = tree:add(lmx, tvb(), "LMX9820A ")
    if part.notes[1] then
        item:add_proto_expert_info(lmx_wrong, part.notes[1])
        return "bluetooth [" .. part.notes[1] .. "]"
    end
    item:add(lmx_fields.type, tvb(1, 1))
    item:add(lmx_fields.opcode, tvb(2, 1))
    item:add_le(lmx_fields.length, tvb(3, 2))
    local name = LMX_NAMES[part.bytes:byte(3)] or ("0x%02x"):format(part.bytes:byte(3))
    local text = LMX_TYPES[part.bytes:byte(2)] .. " " .. name
    if #part.bytes > 7 then
        if part.bytes:byte(2) == 0x43 then
            item:add(lmx_fields.status, tvb(6, 1))
        end
        item:add(lmx_fields.data, tvb(6, #part.bytes - 7))
        text = text .. " " .. hex(part.bytes:sub(7, -2))
    end
    item:append_text(text)
    return text
end

-- Registers on I2C buses ----------------------------------------------------------------------------------------

local bus = Proto("epuck_i2c", "e-puck I2C registers")
local bus_fields = {
    device = ProtoField.string("epuck_i2c.device", "Device"),
    register = ProtoField.uint8("epuck_i2c.register", "Register"),
    name = ProtoField.string("epuck_i2c.name", "Register's name"),
    written = ProtoField.bytes("epuck_i2c.written", "Written"),
    read = ProtoField.bytes("epuck_i2c.read", "Read"),
}
bus.fields = bus_fields

local function emitters()
    local names = { [12] = "RANGE", [13] = "AUX", [14] = "SEND_ALL", [15] = "SEND_EACH", [16] = "BASELINE",
        [17] = "COMPUTE", [20] = "AUX_SHIFT", [21] = "BITS" }
    for i = 0, 11 do
        names[i] = "EMITTER_" .. i
    end
    return names
end
local GROUND = { [0] = "REFLECTED_LEFT", [2] = "REFLECTED_CENTRE", [4] = "REFLECTED_RIGHT", [6] = "AMBIENT_LEFT",
    [8] = "AMBIENT_CENTRE", [10] = "AMBIENT_RIGHT", [12] = "REVISION" }
local CAMERA = { [0] = "DEVICE_ID_H", [1] = "DEVICE_ID_L" }
local DEVICES = {
    [0x20] = { name = "rab", written = emitters(), read = { [0] = "POP", "DATA_15_8", "DATA_7_0", "BEARING_HIGH",
        "BEARING_LOW", "STRENGTH_HIGH", "STRENGTH_LOW", "PEAK_HIGH", "PEAK_LOW", "SENSOR", "DATA_31_24",
        "DATA_23_16" } },
    [0x60] = { name = "ground", read = GROUND, written = GROUND },
    [0x6E] = { name = "camera", read = CAMERA, written = CAMERA },
}

-- A packet is what follows one START: the address byte, then data. A write's first byte chooses the register.
local function take_bus(link, bytes)
    local address, reads = math.floor(bytes:byte(1) / 2), bytes:byte(1) % 2 == 1
    if not DEVICES[address] then
        return {}
    end
    link.pointer = link.pointer or {}
    if not reads and #bytes > 1 then
        link.pointer[address] = bytes:byte(2)
    end
    return { { protocol = "bus", address = address, reads = reads, register = link.pointer[address],
        size = #bytes } }
end

local function show_bus(part, tvb, tree)
    local device = DEVICES[part.address]
    local text = ("0x%02x %s %s"):format(part.address, device.name, part.reads and "read" or "write")
    local item = tree:add(bus, tvb(), "e-puck I2C")
    item:add(bus_fields.device, device.name):set_generated()
    if part.register then
        local alone = not part.reads and part.size == 2
        local name = not alone and device[part.reads and "read" or "written"][part.register]
        item:add(bus_fields.register, part.register):set_generated()
        if name then
            item:add(bus_fields.name, name):set_generated()
        end
        text = text .. (alone and (" select %d"):format(part.register)
            or name and (" %s(%d)"):format(name, part.register) or (" register %d"):format(part.register))
        local first = part.reads and 1 or 2
        if part.size > first then
            local data = tvb(first, part.size - first)
            item:add(part.reads and bus_fields.read or bus_fields.written, data)
            text = text .. " = " .. tostring(data:bytes())
        end
    end
    item:set_text("e-puck I2C " .. text)
    return text
end

-- Mesh frames ---------------------------------------------------------------------------------------------------

local mesh = Proto("xbee_mesh", "XBee mesh frame (puckloop's header)")
local KINDS = { [0] = "data", "acknowledge", "route request", "route reply", "discover", "discovered", "remote AT",
    "remote AT answer" }
local mesh_fields = {
    kind = ProtoField.uint8("xbee_mesh.kind", "Kind", base.DEC, KINDS),
    options = ProtoField.uint8("xbee_mesh.options", "Options", base.HEX),
    radius = ProtoField.uint8("xbee_mesh.radius", "Radius"),
    hops = ProtoField.uint8("xbee_mesh.hops", "Hops"),
    sequence = ProtoField.uint16("xbee_mesh.sequence", "Sequence"),
    origin = ProtoField.uint64("xbee_mesh.origin", "Origin", base.HEX),
    target = ProtoField.uint64("xbee_mesh.target", "Target", base.HEX),
    data = ProtoField.bytes("xbee_mesh.data", "Data"),
}
mesh.fields = mesh_fields
local NETWORK_HEADER, ZEROS, ZEROS_AT = 31, 9, 22

-- What an 802.15.4 data frame carries, if it begins as puckloop's header does. Other networks' dissectors would
-- take some of these frames for theirs, so this one is asked before them.
local function dissect_mesh(tvb, pinfo, tree)
    if tvb:len() < NETWORK_HEADER or not KINDS[tvb(0, 1):uint()]
        or tvb:raw(ZEROS_AT, ZEROS) ~= ("\0"):rep(ZEROS) then
        return false
    end
    pinfo.cols.protocol:set("XBee mesh")
    local item = tree:add(mesh, tvb())
    local at = 0
    for _, one in ipairs({ { "kind", 1 }, { "options", 1 }, { "radius", 1 }, { "hops", 1 }, { "sequence", 2 },
        { "origin", 8 }, { "target", 8 } }) do
        item:add_le(mesh_fields[one[1]], tvb(at, one[2]))
        at = at + one[2]
    end
    local text = ("mesh %s sequence %d"):format(KINDS[tvb(0, 1):uint()], tvb(4, 2):le_uint())
    local size = tvb:len() - NETWORK_HEADER
    if size > 0 then
        item:add(mesh_fields.data, tvb(NETWORK_HEADER, size))
        text = text .. " data " .. tostring(tvb(NETWORK_HEADER, size):bytes())
    end
    item:append_text(": " .. text)
    pinfo.cols.info:set(text)
    return true
end

mesh:register_heuristic("wpan", dissect_mesh)

-- All of them ---------------------------------------------------------------------------------------------------

local puckloop = Proto("puckloop", "puckloop")

function puckloop.init()
    results, links = {}, {}
end

local NOTES = { [FRAMING_ERROR] = "framing error", [PARITY_ERROR] = "wrong parity", [BREAK] = "break" }

local function first_look(encap, interface, tvb, pinfo)
    local bytes = tvb:bytes():raw()
    if encap == I2C then
        links[interface] = links[interface] or {}
        return take_bus(links[interface], bytes)
    end
    local link_name, sender = interface:match("^(%S+) (%S+)$")
    if not link_name or #bytes < SERIAL_HEADER or text_of("comment"):find("not received", 1, true) then
        return {}
    end
    local event, note = bytes:byte(9), NOTES[bytes:byte(9)]
    bytes = bytes:sub(SERIAL_HEADER + 1)
    if event == BREAK then
        bytes = "\0" -- what a receiver has of it
    end
    links[link_name] = links[link_name] or {}
    local link = links[link_name]
    if sender:find("%.xbee$") or sender:find("%.avr$") and link_name:find("%.xbee$") then
        link.kind = "xbee"
    elseif sender:find("%.pic$") and link_name:find("%.uart$") then
        link.kind = "epuck"
    elseif link_name:find("%.bluetooth$") then
        link.kind = "lmx"
    elseif not link.kind and sender:find("%.linux$") and link_name:find("%.uart$") then
        link.kind = bytes:byte(1) == 0x7E and "xbee" or "epuck"
    end
    if link.kind == "epuck" then
        return take_epuck(link, sender:find("%.linux$") ~= nil, bytes, note, pinfo.number, pinfo.abs_ts)
    elseif link.kind == "xbee" then
        link[sender] = link[sender] or {}
        return take_xbee(link[sender], bytes, note, pinfo.number)
    elseif link.kind == "lmx" then
        link[sender] = link[sender] or {}
        return take_lmx(link[sender], bytes, pinfo.number)
    end
    return {}
end

function puckloop.dissector(tvb, pinfo, tree)
    local encap = tonumber(text_of("encap"))
    if tvb:len() < 2 or (encap ~= SERIAL and encap ~= I2C) then
        return
    end
    if not results[pinfo.number] then
        results[pinfo.number] = first_look(encap, text_of("interface"), tvb, pinfo)
    end
    local shown = {}
    for _, part in ipairs(results[pinfo.number]) do
        if part.protocol == "epuck" then
            shown[#shown + 1] = show_epuck(part, pinfo, tree)
        elseif part.protocol == "xbee" then
            shown[#shown + 1] = show_xbee(part, pinfo, tree)
        elseif part.protocol == "lmx" then
            shown[#shown + 1] = show_lmx(part, pinfo, tree)
        else
            shown[#shown + 1] = show_bus(part, tvb, tree)
        end
    end
    if #shown > 0 then
        pinfo.cols.info:set(table.concat(shown, " | "))
    end
end

register_postdissector(puckloop)
