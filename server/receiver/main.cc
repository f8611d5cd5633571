// boxgrasp-receiver: receives from LCM for boxgrasp-server, which starts it, and starts it again when it
// dies. A program of its own, since one that also plans would load a hundred more libraries before it
// listens.
#include "boxgrasp/messaging/isolated_bus.h"

int main(int argc, char** argv) { return boxgrasp::runReceiver(argc - 1, argv + 1); }
