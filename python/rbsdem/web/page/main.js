// The page: its views, and where it begins.

import { addView, gone, setUp, start } from "./machine.js";
import { columnLanes, columnsView } from "./columns.js";
import { frameLanes, frameView } from "./frame.js";

addView(columnsView, columnLanes);
addView(frameView, frameLanes);
setUp();
start().catch(gone);
