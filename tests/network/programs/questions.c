/* Asks the C library's resolver, and the kernel about urgent data: the library's own calls. */
#include <arpa/inet.h>
#include <arpa/nameser.h>
#include <errno.h>
#include <netdb.h>
#include <resolv.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>

static double seconds(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + (double)time.tv_nsec / 1e9;
}

static void show(const char* what, int size, const unsigned char* answer) {
    if (size < 0) {
        printf("%s: %s\n", what, hstrerror(h_errno));
        return;
    }
    ns_msg message;
    ns_rr record;
    if (ns_initparse(answer, size, &message) != 0 || ns_parserr(&message, ns_s_an, 0, &record) != 0) {
        printf("%s: no answer in it\n", what);
        return;
    }
    char text[NS_MAXDNAME] = "";
    if (ns_rr_type(record) == ns_t_a) inet_ntop(AF_INET, ns_rr_rdata(record), text, sizeof text);
    if (ns_rr_type(record) == ns_t_ptr)
        ns_name_uncompress(answer, answer + size, ns_rr_rdata(record), text, sizeof text);
    printf("%s: %s\n", what, text);
}

int main(void) {
    unsigned char answer[NS_PACKETSZ], question[NS_PACKETSZ];
    const double begin = seconds();
    show("query", res_query("server", ns_c_in, ns_t_a, answer, sizeof answer), answer);
    printf("after %.0f s\n", seconds() - begin);
    show("search", res_search("SERVER.", ns_c_in, ns_t_a, answer, sizeof answer), answer);
    show("domain", res_querydomain("server", "", ns_c_in, ns_t_a, answer, sizeof answer), answer);
    show("pointer", res_query("254.0.0.10.in-addr.arpa", ns_c_in, ns_t_ptr, answer, sizeof answer), answer);
    show("nobody", res_query("nobody", ns_c_in, ns_t_a, answer, sizeof answer), answer);
    show("no such record", res_query("server", ns_c_in, ns_t_mx, answer, sizeof answer), answer);
    show("no name", res_query("a..b", ns_c_in, ns_t_a, answer, sizeof answer), answer);
    struct __res_state state;
    memset(&state, 0, sizeof state);
    res_ninit(&state);
    printf("servers %d %s\n", state.nscount, inet_ntoa(state.nsaddr_list[0].sin_addr));
    show("state", res_nquery(&state, "server", ns_c_in, ns_t_a, answer, sizeof answer), answer);
    res_nquery(&state, "nobody", ns_c_in, ns_t_a, answer, sizeof answer);
    printf("its error %d\n", state.res_h_errno);
    const int size = res_nmkquery(&state, ns_o_query, "server", ns_c_in, ns_t_a, NULL, 0, NULL, question, sizeof question);
    show("send", res_nsend(&state, question, size, answer, sizeof answer), answer);
    res_nclose(&state);
    const int one = socket(AF_INET, SOCK_STREAM, 0);
    printf("urgent %s", send(one, "x", 1, MSG_OOB) < 0 ? strerror(errno) : "sent");
    printf(", %s\n", recv(one, answer, 1, MSG_OOB) < 0 ? strerror(errno) : "received");
    return 0;
}
