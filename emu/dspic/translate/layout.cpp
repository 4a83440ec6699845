#include "emu/dspic/translate/layout.h"

namespace puckloop::dspic::translate {

Layout::Layout(const Machine& m) {
    const auto from_state = [&m](const auto& field) {
        return static_cast<int>(reinterpret_cast<const char*>(&field) - reinterpret_cast<const char*>(&m.st));
    };
    w = from_state(m.st.w);
    sr = from_state(m.st.sr);
    corcon = from_state(m.st.corcon);
    cycle = from_state(m.st.cycle);
    rcount = from_state(m.st.rcount);
    disi_end = from_state(m.st.disi_end);
    psvpag = from_state(m.st.psvpag);
    repeat_first = from_state(m.repeat_first);
    current = from_state(m.current);
    code = from_state(m.code);
    limit = from_state(m.limit);
    watch = from_state(m.watch);
    stack_span = from_state(m.stack_span);
    ram = from_state(m.ram);
    instructions = from_state(m.instructions);
    eligible = from_state(m.eligible);
    skip_idle = from_state(m.skip_idle);
    disi_waits = from_state(m.disi_waits);
    line = from_state(m.line);
    plain = from_state(m.plain);
    wait_level = from_state(m.waits.level);
    stays = from_state(m.waits.stays);
    stale_after = from_state(m.waits.stale_after);
    loop_index = from_state(m.loop_index);
    loop_waits = from_state(m.loop_waits);
    entries = from_state(m.translated.entries);
    ram_words = m.ram_words;
    code_words = m.code_words;
    ifs = m.device.ifs;
    iec = m.device.iec;
    ifs_words = m.device.ifs_words;
}

}  // namespace puckloop::dspic::translate
