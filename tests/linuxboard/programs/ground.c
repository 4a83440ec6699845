/* Reads six registers of the I2C device at 0x60 as "write the number, read a byte", then two at once with a
   repeated start, then by SMBus; then from 0x10, where nobody is. */
#include <errno.h>
#include <fcntl.h>
#include <linux/i2c-dev.h>
#include <linux/i2c.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

int main(void) {
    int fd = open("/dev/i2c-3", O_RDWR);
    if (fd < 0 || ioctl(fd, I2C_SLAVE, 0x60) < 0) return 3;
    for (unsigned char reg = 0; reg < 6; reg++) {
        unsigned char value = 0;
        if (write(fd, &reg, 1) != 1 || read(fd, &value, 1) != 1) return 4;
        printf("%02x ", value);
    }
    unsigned char reg = 2;
    unsigned char pair[2] = {0, 0};
    struct i2c_msg messages[2] = {{0x60, 0, 1, &reg}, {0x60, I2C_M_RD, 2, pair}};
    struct i2c_rdwr_ioctl_data both = {messages, 2};
    int done = ioctl(fd, I2C_RDWR, &both);
    printf("| %d %02x %02x ", done, pair[0], pair[1]);
    union i2c_smbus_data data;
    struct i2c_smbus_ioctl_data call = {I2C_SMBUS_READ, 1, I2C_SMBUS_BYTE_DATA, &data};
    done = ioctl(fd, I2C_SMBUS, &call);
    printf("| %d %02x ", done, data.byte);
    ioctl(fd, I2C_SLAVE, 0x10);
    done = (int)write(fd, &reg, 1);
    printf("| %d %s\n", done, done < 0 ? strerror(errno) : "");
    return 0;
}
