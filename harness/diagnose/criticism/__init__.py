"""Model criticism: is what a fit leaves more than noise, and could something unnamed have made it?"""
