"""Model criticism: is what a fit leaves more than noise, and could something unnamed have made it?

A catalogue always fits something. So the forces that nobody has named, which a remainder is examined for, stand against every
finding and against several together: what one of them explains better is doubted, as is, beside a remainder, what does not
explain ten times as much as that holds, unless predictions of the data held out need it. What could be put at many places (a
cogging torque, an error of the encoder, a shaken base, a stop) is not saved by predictions: one of them always fits some of what
something else makes, and recordings of one rig repeat that. Nor is a sensor or a drive, if an unnamed force would leave little of
what it explains acting on both sides of the comparison: not even the side is then known. What a base or a bending link does has
to stand against the force that relaxes in the same way; springs, inertias and dampers at the joint have not, since at a single
frequency any of them is one. Several filters of sensors give way to one force that relaxes: where the swing is nearly linear,
anything with a memory looks like some filters, and two together are a coincidence. Doubted effects are left out, and the others
must then carry predictions alone, for they may have leant on them.
"""
