/* The TAM's pins (TAM fact sheet, section 2). */
#ifndef BOARD_H
#define BOARD_H

/* Port B */
#define PROX_EMIT 0x02   /* infra-red LED of the transceiver */
#define XBEE_NET_1 0x04  /* DIP switches, 1 = open */
#define XBEE_NET_0 0x10
#define PWR_CLEAR 0x08   /* 1: the supply is switched off */
/* Port C */
#define XBEE_RTS 0x04
#define NETWORK_LED 0x08
/* Port D */
#define XBEE_WAKE 0x10
#define XBEE_CTS 0x20    /* the radio module drives it */
#define PROX_SENSE 0x40  /* ICP1: comparator of the infra-red receiver */
#define XBEE_RST 0x80    /* 1: the radio module is held in reset */

/* Analog inputs */
#define FRONT_SENSE 0
#define BATTERY_SENSE 1
#define BACK_SENSE 2

/* USARTs */
#define CONSOLE 0
#define RADIO 1

#endif
