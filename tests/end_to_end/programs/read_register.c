// Reads so many bytes from a register of an I2C device in one combined transfer and prints them in
// hexadecimal: read_register DEVICE ADDRESS REGISTER COUNT [ten]. Status: the error of the transfer.
#include <errno.h>
#include <fcntl.h>
#include <linux/i2c-dev.h>
#include <linux/i2c.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/ioctl.h>

int main(int count, char** words) {
    if (count < 5) return 2;
    const int file = open(words[1], O_RDWR);
    if (file < 0) return 1;
    unsigned char number = (unsigned char)strtol(words[3], NULL, 0), bytes[32] = {0};
    const unsigned short address = (unsigned short)strtol(words[2], NULL, 0);
    const unsigned short length = (unsigned short)strtol(words[4], NULL, 0);
    const unsigned short flags = count > 5 ? I2C_M_TEN : 0;
    struct i2c_msg messages[2] = {{address, flags, 1, &number},
                                  {address, (unsigned short)(flags | I2C_M_RD), length, bytes}};
    struct i2c_rdwr_ioctl_data data = {messages, 2};
    if (length > sizeof bytes || ioctl(file, I2C_RDWR, &data) < 0) {
        printf("error %d\n", errno);
        return errno;
    }
    for (int i = 0; i < length; ++i)
        printf("%02x", bytes[i]);
    printf("\n");
    return 0;
}
