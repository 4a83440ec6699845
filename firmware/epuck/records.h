/* The serial records between the Linux board and this chip; little-endian, which is the compiler's own layout
 * (fact sheet 1.3; protocols/epuck_serial.h is the other end). */
#ifndef EPUCK_RECORDS_H
#define EPUCK_RECORDS_H

#include "types.h"

#define CONFIGURATION_BYTES 4
#define ACTUATOR_BYTES 12
#define SENSOR_BYTES 72
#define WAKE_UP 0x01 /* what Linux sends; any byte is accepted */
#define END 'R'      /* in reset: the session ends; any other value means go on */

struct actuator_record {
    s16 left; /* steps/s */
    s16 right;
    u16 rab_data;
    u8 ring_leds;
    u8 other_leds;
    u8 ircom_enabled;
    u8 ircom_data;
    u8 reset;
    u8 padding;
};

struct sensor_record {
    u16 rab_data;
    u16 rab_range;
    u16 rab_bearing[2]; /* a float */
    s16 proximity[8];
    u16 battery_ok;
    s16 accelerometer[3];
    s16 microphones[4]; /* the last stays 0 */
    s16 light[8];
    u16 rab_received;
    u16 ircom_received;
    u8 ircom_data;
    u8 padding;
    u16 ircom_sensor;
    u16 ircom_range[2];   /* a float */
    u16 ircom_bearing[2]; /* a float */
};

#endif
