// Who draws which world: one line for each kind of body (`kind` in a creature file's [body]).
//
// A picture is a module that exports
//   label   what the canvas shows, in words, for those who cannot see it
//   legend  [[colour, "dot" or "line", words]]; a colour is a name in style.css without its dashes
//   take(plan)   looks at what stays (plan.floor: what the body's `World::floor` gave), forgets what was before;
//                returns width / height of the picture
//   see(state)   looks at what moves (fields of the body's `World::view` stand beside time_s and halt); ten times a second
//   note(state)  may be missing: a line of words beside the title, from the newest state
//   draw({ pen, wide, high, dense, colour })   draws what was seen last on a cleared canvas of wide x high device
//                pixels (dense of them to one of the page); colour(name) is a colour by its name; keeps no pen

import * as floor from "./floor.js";
import * as nest from "./nest.js";

const PICTURES = {
  office: floor,
  nest,
  warehouse: floor,
};

/** The picture for a plan: by the body's kind, else as a floor if it looks like one, else none. */
export function pictureFor(plan) {
  if (!plan.floor) return null;
  if (Object.hasOwn(PICTURES, plan.body ?? "")) return PICTURES[plan.body];
  return Array.isArray(plan.floor.walls) || Array.isArray(plan.floor.boxes) ? floor : null;
}
