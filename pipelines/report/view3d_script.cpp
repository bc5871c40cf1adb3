/// The script of interactive views: decoding, surface normals, a WebGL 2 painter and a plain canvas one,
/// controls.

#include "pipelines/report/view3d.hpp"

namespace brachium::pipelines::report {
namespace {

constexpr std::string_view kModel = R"js(
(function(){
'use strict';
var D=document,alphabet='ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/',code=[];
for(var i=0;i<64;i++)code[alphabet.charCodeAt(i)]=i;
function digits(text,count){var out=new Uint32Array(text.length/count);
for(var i=0,p=0;i<out.length;i++){var v=0;for(var k=0;k<count;k++)v=v*64+code[text.charCodeAt(p++)];out[i]=v}return out}

// The body: points and values by state, decoded when asked for; corners split where the surface has an edge.
function Body(data){
var self=this,states=[],n=0;
function placed(text){var q=digits(text,3),out=new Float32Array(q.length);
for(var i=0;i<q.length;i++)out[i]=data.low[i%3]+q[i]*data.side/262143;return out}
self.state=function(s){if(!states[s])states[s]={x:placed(data.states[s].x),v:data.states[s].v.map(function(t){return digits(t,2)})};return states[s]};
self.reference=data.reference?placed(data.reference):null;
self.count=n=self.state(data.states.length-1).x.length/3;
var x=self.reference||self.state(0).x;
function normal(x,a,b,c){var ux=x[3*b]-x[3*a],uy=x[3*b+1]-x[3*a+1],uz=x[3*b+2]-x[3*a+2];
var vx=x[3*c]-x[3*a],vy=x[3*c+1]-x[3*a+1],vz=x[3*c+2]-x[3*a+2];return[uy*vz-uz*vy,uz*vx-ux*vz,ux*vy-uy*vx]}
self.normal=normal;
var point=[];
self.regions=data.regions.map(function(r){
var t=digits(r.t,3),corners=new Uint32Array(t.length),groups={};
for(var i=0;i<t.length;i+=3){var m=normal(x,t[i],t[i+1],t[i+2]),l=Math.hypot(m[0],m[1],m[2])||1;
for(var k=0;k<3;k++){var list=groups[t[i+k]]||(groups[t[i+k]]=[]),hit=null;
for(var g=0;g<list.length&&!hit;g++){var s=list[g].n,e=Math.hypot(s[0],s[1],s[2])||1;
if((s[0]*m[0]+s[1]*m[1]+s[2]*m[2])>.76*e*l)hit=list[g]}
if(!hit){hit={n:[0,0,0],id:point.length};list.push(hit);point.push(t[i+k])}
for(var a=0;a<3;a++)hit.n[a]+=m[a]/l;corners[i+k]=hit.id}}
return{name:r.name,points:t,corners:corners,edges:digits(r.e,3),shown:true}});
self.point=new Uint32Array(point);
self.normals=function(x){var out=new Float32Array(3*point.length);
self.regions.forEach(function(r){for(var i=0;i<r.points.length;i+=3){var m=normal(x,r.points[i],r.points[i+1],r.points[i+2]);
for(var k=0;k<3;k++)for(var a=0;a<3;a++)out[3*r.corners[i+k]+a]+=m[a]}});return out};
// Sides of triangles on the reference surface of all regions together: those at a sharp edge, and the others with
// both their triangles, which are drawn where one faces the reader and the other does not.
self.sides=(function(){if(!self.reference)return[];var all={},inner={},out=[];
self.regions.forEach(function(r){for(var i=0;i<r.points.length;i+=3){var key=[r.points[i],r.points[i+1],r.points[i+2]].sort().join();inner[key]=(inner[key]||0)+1}});
self.regions.forEach(function(r){var t=r.points;for(var i=0;i<t.length;i+=3){
if(inner[[t[i],t[i+1],t[i+2]].sort().join()]>1)continue;
var m=normal(self.reference,t[i],t[i+1],t[i+2]),l=Math.hypot(m[0],m[1],m[2])||1;m=[m[0]/l,m[1]/l,m[2]/l];
for(var k=0;k<3;k++){var a=t[i+k],b=t[i+(k+1)%3],id=a<b?a+','+b:b+','+a;(all[id]||(all[id]={a:a,b:b,n:[]})).n.push(m)}}});
for(var id in all){var s=all[id];s.sharp=s.n.length<2||s.n[0][0]*s.n[1][0]+s.n[0][1]*s.n[1][1]+s.n[0][2]*s.n[1][2]<.76;out.push(s)}
return out})();
}

// The look: rows of a turning matrix, zoom and shift in units of the picture's height.
function Look(first){this.first=first;this.reset()}
Look.prototype={
reset:function(){this.r=this.first.slice();this.zoom=1;this.x=0;this.y=0},
turn:function(across,down){var r=this.r,c=Math.cos(across),s=Math.sin(across),k,a,b;
for(k=0;k<3;k++){a=r[k];b=r[6+k];r[k]=c*a+s*b;r[6+k]=c*b-s*a}
c=Math.cos(down);s=Math.sin(down);
for(k=0;k<3;k++){a=r[3+k];b=r[6+k];r[3+k]=c*a-s*b;r[6+k]=s*a+c*b}
this.upright()},
upright:function(){var r=this.r,l=Math.hypot(r[0],r[1],r[2]);for(var k=0;k<3;k++)r[k]/=l;
var d=r[0]*r[3]+r[1]*r[4]+r[2]*r[5];for(k=0;k<3;k++)r[3+k]-=d*r[k];l=Math.hypot(r[3],r[4],r[5]);for(k=0;k<3;k++)r[3+k]/=l;
r[6]=r[1]*r[5]-r[2]*r[4];r[7]=r[2]*r[3]-r[0]*r[5];r[8]=r[0]*r[4]-r[1]*r[3]}};
function lookAt(r,x,p){return[r[0]*x[3*p]+r[1]*x[3*p+1]+r[2]*x[3*p+2],r[3]*x[3*p]+r[4]*x[3*p+1]+r[5]*x[3*p+2],r[6]*x[3*p]+r[7]*x[3*p+1]+r[8]*x[3*p+2]]}
)js";

constexpr std::string_view kPainters = R"js(
var LIGHT=[-.36,.5,.79],GREY=[150/255,150/255,150/255];
function colours(map){var out=[];for(var i=0;i<map.length;i+=6)out.push([0,2,4].map(function(k){return parseInt(map.substr(i+k,2),16)/255}));return out}

function glPainter(canvas,body,map){
var gl=canvas.getContext('webgl2',{antialias:true,alpha:true,premultipliedAlpha:true,preserveDrawingBuffer:true});
if(!gl)return null;
function program(vs,fs){var p=gl.createProgram();[[gl.VERTEX_SHADER,vs],[gl.FRAGMENT_SHADER,fs]].forEach(function(s){
var h=gl.createShader(s[0]);gl.shaderSource(h,'#version 300 es\nprecision highp float;'+s[1]);gl.compileShader(h);gl.attachShader(p,h)});
gl.bindAttribLocation(p,0,'p');gl.bindAttribLocation(p,1,'n');gl.bindAttribLocation(p,2,'v');gl.linkProgram(p);
if(!gl.getProgramParameter(p,gl.LINK_STATUS))throw new Error(gl.getProgramInfoLog(p));
p.at=function(name){return gl.getUniformLocation(p,name)};return p}
var place='uniform mat3 r;uniform vec3 c;uniform vec4 s;uniform vec2 d;vec4 at(vec3 p){vec3 q=r*(p-c);return vec4(q.xy*s.xy+s.zw,-q.z*d.x+d.y,1.);}';
var solid=program('in vec3 p,n;in float v;out vec3 m;out float t;'+place+'void main(){m=r*n;t=v;gl_Position=at(p);}',
'in vec3 m;in float t;uniform sampler2D map;uniform vec3 grey;out vec4 o;void main(){vec3 n=normalize(m);if(n.z<0.)n=-n;'+
'vec3 k=t<0.?grey:texture(map,vec2(.5/64.+t*63./64.,.5)).rgb;float l=max(dot(n,vec3(-.36,.5,.79)),0.);o=vec4(k*(.58+.42*l)+.10*pow(l,24.),1.);}');
var line=program('in vec3 p;'+place+'void main(){gl_Position=at(p);}','uniform vec4 k;out vec4 o;void main(){o=vec4(k.rgb*k.a,k.a);}');
var tex=gl.createTexture(),pixels=new Uint8Array(256);
map.forEach(function(c,i){pixels.set([255*c[0],255*c[1],255*c[2],255],4*i)});
gl.bindTexture(gl.TEXTURE_2D,tex);gl.texImage2D(gl.TEXTURE_2D,0,gl.RGBA,64,1,0,gl.RGBA,gl.UNSIGNED_BYTE,pixels);
[gl.TEXTURE_WRAP_S,gl.TEXTURE_WRAP_T].forEach(function(w){gl.texParameteri(gl.TEXTURE_2D,w,gl.CLAMP_TO_EDGE)});
[gl.TEXTURE_MIN_FILTER,gl.TEXTURE_MAG_FILTER].forEach(function(w){gl.texParameteri(gl.TEXTURE_2D,w,gl.LINEAR)});
var n=body.point.length,buffers=[0,1,2,3,4].map(function(){return gl.createBuffer()});
function fill(b,array,kind){gl.bindBuffer(kind||gl.ARRAY_BUFFER,b);gl.bufferData(kind||gl.ARRAY_BUFFER,array,gl.DYNAMIC_DRAW)}
function attribute(k,b,size){gl.bindBuffer(gl.ARRAY_BUFFER,b);gl.enableVertexAttribArray(k);gl.vertexAttribPointer(k,size,gl.FLOAT,false,0,0)}
body.regions.forEach(function(r){r.glt=gl.createBuffer();fill(r.glt,r.corners,gl.ELEMENT_ARRAY_BUFFER);r.gle=gl.createBuffer();fill(r.gle,r.edges,gl.ELEMENT_ARRAY_BUFFER)});
var shown=null;
return{kind:'webgl2',
draw:function(f){
if(shown!==f.x||f.fresh){var p=new Float32Array(3*n),v=new Float32Array(n);
for(var i=0;i<n;i++){var q=body.point[i];p[3*i]=f.x[3*q];p[3*i+1]=f.x[3*q+1];p[3*i+2]=f.x[3*q+2];v[i]=f.value(q)}
fill(buffers[0],p);fill(buffers[1],body.normals(f.x));fill(buffers[2],v);fill(buffers[3],f.x);shown=f.x}
var w=canvas.width,h=canvas.height,s=2*f.scale;
gl.viewport(0,0,w,h);gl.clearColor(0,0,0,0);gl.clear(gl.COLOR_BUFFER_BIT|gl.DEPTH_BUFFER_BIT);gl.enable(gl.DEPTH_TEST);gl.enable(gl.BLEND);gl.blendFunc(gl.ONE,gl.ONE_MINUS_SRC_ALPHA);
var r=f.look.r,m=[r[0],r[3],r[6],r[1],r[4],r[7],r[2],r[5],r[8]],depth=.5/f.reach;
function common(p,bias){gl.useProgram(p);gl.uniformMatrix3fv(p.at('r'),false,m);gl.uniform3fv(p.at('c'),f.centre);
gl.uniform4f(p.at('s'),s/w,s/h,2*f.look.x*h/w,2*f.look.y);gl.uniform2f(p.at('d'),depth,bias)}
common(solid,0);gl.uniform3fv(solid.at('grey'),GREY);gl.bindTexture(gl.TEXTURE_2D,tex);
attribute(0,buffers[0],3);attribute(1,buffers[1],3);attribute(2,buffers[2],1);
gl.enable(gl.POLYGON_OFFSET_FILL);gl.polygonOffset(1,1);
body.regions.forEach(function(q){if(!q.shown)return;gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER,q.glt);gl.drawElements(gl.TRIANGLES,q.corners.length,gl.UNSIGNED_INT,0)});
gl.disable(gl.POLYGON_OFFSET_FILL);gl.disableVertexAttribArray(1);gl.disableVertexAttribArray(2);
common(line,-.0008);
if(f.edges){attribute(0,buffers[3],3);gl.uniform4f(line.at('k'),0,0,0,.34);
body.regions.forEach(function(q){if(!q.shown)return;gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER,q.gle);gl.drawElements(gl.LINES,q.edges.length,gl.UNSIGNED_INT,0)})}
if(f.outline.length){fill(buffers[4],f.outline);attribute(0,buffers[4],3);gl.uniform4f(line.at('k'),f.ink[0],f.ink[1],f.ink[2],.75);gl.drawArrays(gl.LINES,0,f.outline.length/3)}
}}}

function flatPainter(canvas,body,map){
var c=canvas.getContext('2d');
function css(k,l){return'rgb('+k.map(function(v){return Math.round(255*v*l)}).join()+')'}
return{kind:'canvas2d',draw:function(f){
var w=canvas.width,h=canvas.height,n=body.count,at=new Float32Array(3*n),faces=[],r=f.look.r,p,q;
for(p=0;p<n;p++){q=lookAt(r,[f.x[3*p]-f.centre[0],f.x[3*p+1]-f.centre[1],f.x[3*p+2]-f.centre[2]],0);
at[3*p]=w/2+f.look.x*h+f.scale*q[0];at[3*p+1]=h/2-f.look.y*h-f.scale*q[1];at[3*p+2]=q[2]*f.scale}
body.regions.forEach(function(g){if(!g.shown)return;
if(!g.sides){g.sides={};for(var j=0;j<g.edges.length;j+=2)g.sides[Math.min(g.edges[j],g.edges[j+1])+','+Math.max(g.edges[j],g.edges[j+1])]=1}
for(var i=0;i<g.points.length;i+=3){
var a=g.points[i],b=g.points[i+1],d=g.points[i+2],m=body.normal(at,a,d,b);if(m[2]<=0)continue;
faces.push([at[3*a+2]+at[3*b+2]+at[3*d+2],a,b,d,m,g.sides])}});
faces.sort(function(a,b){return a[0]-b[0]});
c.clearRect(0,0,w,h);c.lineJoin='round';
if(f.outline.length){c.strokeStyle=css(f.ink,1);c.globalAlpha=.75;c.lineWidth=1;c.beginPath();
for(var i=0;i<f.outline.length;i+=6)for(var e=0;e<2;e++){q=lookAt(r,[f.outline[i+3*e]-f.centre[0],f.outline[i+3*e+1]-f.centre[1],f.outline[i+3*e+2]-f.centre[2]],0);
c[e?'lineTo':'moveTo'](w/2+f.look.x*h+f.scale*q[0],h/2-f.look.y*h-f.scale*q[1])}
c.stroke();c.globalAlpha=1}
c.lineWidth=.8;
faces.forEach(function(t){var m=t[4],l=Math.max((m[0]*LIGHT[0]-m[1]*LIGHT[1]+m[2]*LIGHT[2])/Math.hypot(m[0],m[1],m[2]),0);
var v=[f.value(t[1]),f.value(t[2]),f.value(t[3])],k=Math.min.apply(null,v)<0?GREY:map[Math.round(21*(v[0]+v[1]+v[2]))];
c.fillStyle=c.strokeStyle=css(k,.58+.42*l);c.beginPath();c.moveTo(at[3*t[1]],at[3*t[1]+1]);c.lineTo(at[3*t[2]],at[3*t[2]+1]);c.lineTo(at[3*t[3]],at[3*t[3]+1]);c.closePath();c.fill();c.stroke();
if(f.edges)for(var j=1;j<4;j++){var p=t[j],q=t[j%3+1];if(!t[5][Math.min(p,q)+','+Math.max(p,q)])continue;
c.strokeStyle='rgba(0,0,0,.34)';c.beginPath();c.moveTo(at[3*p],at[3*p+1]);c.lineTo(at[3*q],at[3*q+1]);c.stroke()}});
}}}
)js";

constexpr std::string_view kControls = R"js(
function element(tag,attributes,parent){var e=D.createElement(tag);for(var k in attributes)if(k==='text')e.textContent=attributes[k];else e.setAttribute(k,attributes[k]);if(parent)parent.appendChild(e);return e}
function step(span,count){var s=Math.pow(10,Math.floor(Math.log10(span/count)));return[1,2,5,10].map(function(k){return k*s}).find(function(k){return span/k<=count+1e-9})}
function written(v,s){var d=Math.max(0,-Math.floor(Math.log10(s)+1e-9)),t=Math.abs(v)<s*1e-6?'0':Math.abs(v)>=1e7||s<1e-6?v.toPrecision(4):v.toFixed(d);return t.replace('-','\u2212')}

function show(figure){
var data=JSON.parse(figure.querySelector('script').textContent),body=new Body(data),look=new Look(data.look),map=colours(data.map);
var bar=element('div',{class:'v3bar'},figure),stage=element('div',{class:'v3stage'},figure),foot=element('div',{class:'v3bar'},figure);
var poster=figure.querySelector('svg.poster');figure.insertBefore(bar,poster);figure.insertBefore(stage,poster);figure.insertBefore(foot,poster);
var canvas=element('canvas',{tabindex:0,role:'img','aria-label':figure.querySelector('figcaption').textContent+': turn with the arrow keys, + and \u2212 zoom, 0 resets, space plays'},stage);
var over=element('canvas',{class:'v3over','aria-hidden':'true'},stage),tip=element('div',{class:'v3tip'},stage);
var painter=null;try{painter=glPainter(canvas,body,map)}catch(e){painter=null}
if(!painter){var plain=element('canvas',{tabindex:0,role:'img','aria-label':canvas.getAttribute('aria-label')});stage.replaceChild(plain,canvas);canvas=plain;painter=flatPainter(canvas,body,map)}
figure.dataset.painter=painter.kind;
var now=data.states.length-1,field=0,edges=true,outline=!!body.reference,fresh=true,pending=false,timer=0,hover=null;
// Centre and reach of all states; the first look fills the picture with them.
var low=[1e30,1e30,1e30],high=[-1e30,-1e30,-1e30],centre,reach=0,half=[0,0];
data.states.forEach(function(_,s){var x=body.state(s).x;for(var i=0;i<x.length;i++){low[i%3]=Math.min(low[i%3],x[i]);high[i%3]=Math.max(high[i%3],x[i])}});
centre=[0,1,2].map(function(a){return(low[a]+high[a])/2});
(function(){var x=body.state(now).x,all=body.reference?[x,body.reference,body.state(0).x]:[x,body.state(0).x];
all.forEach(function(x){for(var p=0;p<body.count;p++){var q=lookAt(look.r,[x[3*p]-centre[0],x[3*p+1]-centre[1],x[3*p+2]-centre[2]],0);
half[0]=Math.max(half[0],Math.abs(q[0]));half[1]=Math.max(half[1],Math.abs(q[1]));reach=Math.max(reach,Math.hypot(q[0],q[1],q[2]))}})})();
reach=1.6*(reach||1);

function value(p){var v=data.fields.length?body.state(now).v[field][p]:4095;return v===4095?-1:v/4094}
function pixels(){var h=canvas.height,w=canvas.width;return look.zoom*Math.min(.44*w/(half[0]||1),.40*h/(half[1]||1))}
function outlineNow(){if(!outline)return new Float32Array(0);var r=look.r,out=[],x=body.reference;
body.sides.forEach(function(s){var a=s.n[0],b=s.n[1],front=function(m){return r[6]*m[0]+r[7]*m[1]+r[8]*m[2]>0};
if(s.sharp||front(a)!==front(b))out.push(x[3*s.a],x[3*s.a+1],x[3*s.a+2],x[3*s.b],x[3*s.b+1],x[3*s.b+2])});return new Float32Array(out)}
function ink(){return(getComputedStyle(figure).color.match(/[\d.]+/g)||[0,0,0]).slice(0,3).map(function(v){return v/255})}
function later(){if(!pending){pending=true;requestAnimationFrame(draw)}}
function draw(){pending=false;var ratio=Math.min(window.devicePixelRatio||1,2),w=Math.round(stage.clientWidth*ratio),h=Math.round(stage.clientHeight*ratio);
if(!w||!h)return;
[canvas,over].forEach(function(c){if(c.width!==w||c.height!==h){c.width=w;c.height=h}});
painter.draw({x:body.state(now).x,value:value,look:look,scale:pixels(),centre:centre,reach:reach,edges:edges,outline:outlineNow(),ink:ink(),fresh:fresh});
fresh=false;decorate(ratio)}
function decorate(ratio){var c=over.getContext('2d'),w=over.width/ratio,h=over.height/ratio,scale=pixels()/ratio,style=getComputedStyle(figure);
c.setTransform(ratio,0,0,ratio,0,0);c.clearRect(0,0,w,h);c.fillStyle=c.strokeStyle=style.color;c.font='12px '+style.fontFamily;c.textAlign='center';c.textBaseline='middle';
var size=step(150/scale,1),px=size*scale,right=w-18,y=h-26;
c.lineWidth=1.4;c.beginPath();c.moveTo(right-px,y-5);c.lineTo(right-px,y);c.lineTo(right,y);c.lineTo(right,y-5);c.stroke();
c.fillText(written(size,size)+' '+data.unit,right-px/2,y+13);
[0,1,2].map(function(a){return[look.r[a],look.r[3+a],look.r[6+a],'xyz'[a]]}).sort(function(a,b){return a[2]-b[2]}).forEach(function(a){
c.globalAlpha=a[2]<-.1?.5:1;c.beginPath();c.moveTo(44,h-44);c.lineTo(44+24*a[0],h-44-24*a[1]);c.stroke();c.fillText(a[3],44+33*a[0],h-44-33*a[1])});c.globalAlpha=1}

// ---- controls
var label=element('label',{text:'Colour by '},bar),select=element('select',{},label);
data.fields.forEach(function(f,k){element('option',{value:k,text:f.label},select)});
if(!data.fields.length)label.remove();
var legend=element('div',{class:'v3legend','aria-hidden':'true'},bar);
function legendNow(){legend.textContent='';if(!data.fields.length)return;var f=data.fields[field],strip=element('div',{class:'v3strip'},legend);
strip.style.background='linear-gradient(90deg,'+map.map(function(k){return'rgb('+k.map(function(v){return Math.round(255*v)}).join()+')'}).join()+')';
var s=step(f.high-f.low,5);
for(var v=Math.ceil(f.low/s-1e-9)*s;v<=f.high+1e-9*s;v+=s){var at=100*(v-f.low)/(f.high-f.low);
var t=element('span',{text:written(v,s)},legend);t.style.left=Math.min(Math.max(at,0),100)+'%'}
if(f.cut)legend.title='Colours cover 99 % of the values; '+(f.cut===1?'lower':f.cut===2?'higher':'lower and higher')+' ones have the colour of the end.'}
select.addEventListener('change',function(){field=+select.value;fresh=true;legendNow();later()});

var many=data.states.length>1,play=element('button',{type:'button','aria-label':'play the states'},foot),slider=element('input',{type:'range',min:0,max:data.states.length-1,step:1,value:now,'aria-label':'state'},foot);
var told=element('output',{class:'v3state'},foot);
function stateNow(s){now=s;slider.value=s;told.textContent=(many?s+1+' / '+data.states.length+'  ':'')+data.states[s].label;fresh=true;later()}
function stop(){clearInterval(timer);timer=0;play.textContent='\u25b6'}
function toggle(){if(timer)return stop();if(!many)return;play.textContent='\u23f8';if(now===data.states.length-1)stateNow(0);
timer=setInterval(function(){if(now===data.states.length-1)return stop();stateNow(now+1)},Math.max(90,Math.min(450,6000/data.states.length)))}
play.textContent='\u25b6';play.addEventListener('click',toggle);slider.addEventListener('input',function(){stop();stateNow(+slider.value)});
if(!many){play.remove();slider.remove()}
var checks=element('span',{class:'v3checks'},foot);
function check(text,on,change){var l=element('label',{},checks),i=element('input',{type:'checkbox'},l);i.checked=on;l.appendChild(D.createTextNode(text));i.addEventListener('change',function(){change(i.checked);later()})}
if(body.regions.length>1)body.regions.forEach(function(r){check(r.name,true,function(on){r.shown=on})});
if(body.regions.some(function(r){return r.edges.length}))check('cell edges',true,function(on){edges=on});
if(body.reference)check('undeformed outline',outline,function(on){outline=on});
var reset=element('button',{type:'button',text:'Reset view'},checks);reset.addEventListener('click',function(){look.reset();later()});

// ---- pointer and keys
var held={},gap=0,middle=null;
function spot(e){var b=stage.getBoundingClientRect();return[e.clientX-b.left,e.clientY-b.top,b.height]}
function zoom(k){look.zoom=Math.min(40,Math.max(.2,look.zoom*k));later()}
canvas.addEventListener('pointerdown',function(e){canvas.focus({preventScroll:true});canvas.setPointerCapture(e.pointerId);held[e.pointerId]=spot(e);gap=0;tip.style.display='none'});
canvas.addEventListener('pointermove',function(e){var p=spot(e),ids=Object.keys(held);
if(!held[e.pointerId])return probe(p);
var q=held[e.pointerId],dx=p[0]-q[0],dy=p[1]-q[1];held[e.pointerId]=p;
if(ids.length===2){var a=held[ids[0]],b=held[ids[1]],g=Math.hypot(a[0]-b[0],a[1]-b[1]),m=[(a[0]+b[0])/2,(a[1]+b[1])/2];
if(gap){look.zoom=Math.min(40,Math.max(.2,look.zoom*g/gap));look.x+=(m[0]-middle[0])/p[2];look.y-=(m[1]-middle[1])/p[2]}gap=g;middle=m}
else if(e.shiftKey||e.buttons&6){look.x+=dx/p[2];look.y-=dy/p[2]}
else look.turn(-dx*.009,dy*.009);
later()});
['pointerup','pointercancel'].forEach(function(n){canvas.addEventListener(n,function(e){delete held[e.pointerId];gap=0})});
canvas.addEventListener('pointerleave',function(){tip.style.display='none'});
canvas.addEventListener('contextmenu',function(e){e.preventDefault()});
canvas.addEventListener('wheel',function(e){if(D.activeElement!==canvas&&!e.ctrlKey)return;e.preventDefault();zoom(Math.exp(-e.deltaY*.0015))},{passive:false});
canvas.addEventListener('dblclick',function(){look.reset();later()});
canvas.addEventListener('keydown',function(e){var k=e.key,s=.12,t={ArrowLeft:[s,0],ArrowRight:[-s,0],ArrowUp:[0,-s],ArrowDown:[0,s]}[k];
if(t&&e.shiftKey){look.x-=t[0]/3;look.y-=t[1]/3}else if(t)look.turn(t[0],t[1]);
else if(k==='+'||k==='=')zoom(1.2);else if(k==='-')zoom(1/1.2);else if(k==='0'||k==='Home')look.reset();else if(k===' ')toggle();
else if(k==='PageUp'||k===','){stop();stateNow(Math.max(0,now-1))}else if(k==='PageDown'||k==='.'){stop();stateNow(Math.min(data.states.length-1,now+1))}else return;
e.preventDefault();later()});
function probe(p){if(!data.fields.length)return;var ratio=canvas.width/stage.clientWidth,s=pixels()/ratio,w=stage.clientWidth,h=stage.clientHeight,x=body.state(now).x,best=-1,depth=-1e30;
var seen={};body.regions.forEach(function(r){if(!r.shown)return;for(var i=0;i<r.points.length;i++){var k=r.points[i];if(seen[k])continue;seen[k]=1;
var q=lookAt(look.r,[x[3*k]-centre[0],x[3*k+1]-centre[1],x[3*k+2]-centre[2]],0);
var d=Math.hypot(w/2+look.x*h+s*q[0]-p[0],h/2-look.y*h-s*q[1]-p[1]);if(d<11&&q[2]*s-d>depth){depth=q[2]*s-d;best=k}}});
if(best<0){tip.style.display='none';return}
var v=body.state(now).v[field][best],f=data.fields[field],side=v===0&&f.cut&1?'\u2264 ':v===4094&&f.cut&2?'\u2265 ':'';
tip.textContent=v===4095?'no value here':side+written(f.low+v*(f.high-f.low)/4094,step((f.high-f.low)/200,1));
tip.style.display='block';tip.style.left=Math.min(p[0]+14,w-110)+'px';tip.style.top=p[1]+12+'px'}
canvas.addEventListener('webglcontextlost',function(e){e.preventDefault();stop()});
canvas.addEventListener('webglcontextrestored',function(){try{painter=glPainter(canvas,body,map)}catch(x){return}fresh=true;later()});
if(window.ResizeObserver)new ResizeObserver(later).observe(stage);else addEventListener('resize',later);
if(window.matchMedia)matchMedia('(prefers-color-scheme:dark)').addEventListener('change',later);
element('p',{class:'note v3help',text:'Drag to turn, Shift and drag to move; click it, then the wheel (or two fingers) zooms. Keys: arrows turn, + and \u2212 zoom, 0 resets, space plays, comma and full stop step.'},figure);
figure.classList.add('live');legendNow();stateNow(now)}

// A view is made when it first comes into sight: browsers keep few WebGL contexts.
[].forEach.call(D.querySelectorAll('figure.view3d'),function(f){if(!f.querySelector('script'))return;
function begin(){try{show(f)}catch(e){f.classList.remove('live');[].forEach.call(f.querySelectorAll('.v3bar,.v3stage'),function(b){b.remove()});f.dataset.painter='none: '+e.message}}
if(!window.IntersectionObserver)return begin();
var o=new IntersectionObserver(function(entries){if(entries.some(function(e){return e.isIntersecting})){o.disconnect();begin()}},{rootMargin:'200px'});o.observe(f)});
})();
)js";

}  // namespace

std::string_view view3d_script() {
  static const std::string script = std::string(kModel) + std::string(kPainters) + std::string(kControls);
  return script;
}

}  // namespace brachium::pipelines::report
