/* In the boot section: writes a page of the application by avr-libc, and sees the busy section and lock bits. */
#include "driver.h"

#include <avr/boot.h>
#include <avr/pgmspace.h>

DRIVER

int main(void) {
    const uint32_t page = 0x4000;
    result[0] = pgm_read_byte_far(page + 6);
    boot_page_erase_safe(page);
    result[1] = boot_rww_busy() != 0;
    result[2] = pgm_read_byte_far(0); /* the application cannot be read meanwhile */
    result[3] = boot_spm_busy() != 0;
    boot_spm_busy_wait();
    for (uint16_t i = 0; i < SPM_PAGESIZE; i += 2)
        boot_page_fill_safe(page + i, (uint16_t)(input[i & 31] | input[(i + 1) & 31] << 8));
    TCCR1B = _BV(CS11) | _BV(CS10); /* /64 */
    TCNT1 = 0;
    boot_page_write_safe(page);
    boot_spm_busy_wait();
    stamps[0] = TCNT1;
    result[4] = pgm_read_byte_far(page + 6);
    boot_rww_enable_safe();
    for (uint8_t i = 0; i < 32; ++i)
        result[16 + i] = pgm_read_byte_far(page + i);
    /* With BLB12:11 = mode 2 the boot section may no longer be written. */
    boot_lock_bits_set_safe(_BV(BLB11));
    boot_page_erase_safe(0x1FF00);
    boot_spm_busy_wait();
    boot_rww_enable_safe();
    result[5] = pgm_read_byte_far(0x1FF00);
    result[6] = boot_lock_fuse_bits_get(GET_LOCK_BITS);
    finished();
}
const uint8_t kept[] __attribute__((section(".kept"), used)) = {0x5A};
