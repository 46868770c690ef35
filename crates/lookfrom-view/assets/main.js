// The page of a server.

import { showPage } from "./page.js";
import { connect } from "./socket.js";
import { webSocket } from "./web-socket.js";

showPage(connect(webSocket()), { fits: true });
