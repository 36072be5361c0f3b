// Ctrl-C as a request to stop: a verb ends soon, keeps its finished results and marks them as interrupted.
#pragma once

namespace ukemi::tools {

/// From now on SIGINT (Ctrl-C) and SIGTERM are requests; a second one ends the program at once. Called by code that
/// polls them (Run::monitor): a verb that never does is ended by the first signal, and earlier results stay.
void catch_interrupts();
/// Whether a request to stop has arrived.
bool interrupted();

}  // namespace ukemi::tools
